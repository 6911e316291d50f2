"""What can be wrong about results."""

from http import HTTPStatus

from backend.platform.problems import NotFound, ServiceError
from dropflow.errors import FieldProblem


class NotYet(NotFound):
    """The run has not come to it, or ended before it did."""

    def __init__(self) -> None:
        super().__init__(
            "There is no such result yet.", code="results.not_yet", hint="It appears when its stage has come to it."
        )


class NoSuchResult(NotFound):
    """No run makes this."""

    def __init__(self) -> None:
        super().__init__("No run makes a result of this name.", code="not_found.result")


class FrameMissing(ServiceError):
    """The figure is of one frame, and none was given."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self) -> None:
        super().__init__(
            "This figure is of one frame.", code="request.invalid", fields=[FieldProblem("frame", "is needed")]
        )
