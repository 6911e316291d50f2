"""What can be wrong about results."""

from http import HTTPStatus

from backend.platform.problems import NotFound, ServiceError


class NotYet(NotFound):
    """The run has not come to it, or ended before it did."""

    def __init__(self) -> None:
        super().__init__(
            "There is no such result yet.", code="results.not_yet", hint="It appears when its stage has come to it."
        )


class NotKept(NotFound):
    """The analysis was made by a version that did not keep it."""

    def __init__(self) -> None:
        super().__init__(
            "This run was made by a version that kept no frame to show this step of detection on.",
            code="results.not_kept",
            hint="Choose a frame, or run the experiment again.",
        )


class NoSuchResult(NotFound):
    """No run makes this."""

    def __init__(self) -> None:
        super().__init__("No run makes a result of this name.", code="not_found.result")


class ExportsBusy(ServiceError):
    """Exports take a process each, and there are as many as there may be."""

    status = HTTPStatus.SERVICE_UNAVAILABLE

    def __init__(self) -> None:
        super().__init__(
            "Other exports are being made.",
            code="service.busy",
            hint="Try again when they are through: a minute or so.",
        )


class NoTable(NotFound):
    """A figure that is a picture, or needs more than a table."""

    def __init__(self, name: str) -> None:
        super().__init__(f"The figure {name} has no table.", code="not_found.table", hint="See the list of figures.")


class NotOfThisFilm(NotFound):
    """The experiment lacks what the figure shows."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason, code="results.not_of_this_film")
