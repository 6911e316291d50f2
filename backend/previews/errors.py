"""What can go wrong with previews."""

from http import HTTPStatus

from backend.platform.problems import Problem, ServiceError
from dropflow.errors import FieldProblem


class PreviewLate(ServiceError):
    """No worker answered in time."""

    default_code = "preview.late"
    status = HTTPStatus.SERVICE_UNAVAILABLE

    def __init__(self) -> None:
        super().__init__("No worker had time for this preview.", hint="Try again in a moment.")


class PreviewFailed(ServiceError):
    """The frames or parameters do not allow it; the worker said why."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self, problem: Problem) -> None:
        fields = [FieldProblem(found.field, found.message) for found in problem.errors]
        super().__init__(problem.detail, code=problem.code, frame=problem.frame, fields=fields, hint=problem.hint)
