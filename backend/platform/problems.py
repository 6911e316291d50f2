"""Every error as `application/problem+json`: rendered here, and kept in this shape with runs and stacks."""

from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from sqlalchemy.exc import OperationalError
from sqlalchemy.exc import TimeoutError as PoolExhausted
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from backend.platform.methods import allowed_methods
from backend.platform.reasons import reason_of
from dropflow.errors import DropflowError, FieldProblem

MEDIA_TYPE = "application/problem+json"
log = structlog.get_logger()


class FieldError(BaseModel):
    """What is wrong with one field."""

    field: str
    message: str


class Problem(BaseModel):
    """What went wrong, where, and what to do."""

    type: str = "about:blank"
    title: str
    status: int
    code: str
    """Stable: programs may rely on it."""
    detail: str
    errors: list[FieldError] = []
    file: str | None = None
    frame: int | None = None
    hint: str | None = None


class ServiceError(DropflowError):
    """An expected answer of the service other than success; nouns derive theirs in `errors.py`."""

    status: int = HTTPStatus.BAD_REQUEST

    def __init__(
        self, message: str, *, status: int | None = None, headers: Mapping[str, str] | None = None, **about: Any
    ) -> None:
        super().__init__(message, **about)
        self.status = status or self.status
        self.headers = headers


class NotFound(ServiceError):
    """It does not exist, or this person may not see it: both answer the same."""

    default_code = "not_found"
    status = HTTPStatus.NOT_FOUND


class Conflict(ServiceError):
    """It cannot be done in this state."""

    default_code = "conflict"
    status = HTTPStatus.CONFLICT


def problem_of(error: DropflowError) -> Problem:
    """The library's errors are about what was given (422); the service's say their own status."""
    status = error.status if isinstance(error, ServiceError) else HTTPStatus.UNPROCESSABLE_ENTITY
    return Problem(
        title=_phrase(status),
        status=status,
        code=error.code,
        detail=error.message,
        errors=[FieldError(field=found.field, message=found.message) for found in error.fields],
        file=error.file,
        frame=error.frame,
        hint=error.hint,
    )


def problem_response(problem: Problem, headers: Mapping[str, str] | None = None) -> JSONResponse:
    """Render `problem`."""
    return JSONResponse(problem.model_dump(), problem.status, headers=dict(headers or {}), media_type=MEDIA_TYPE)


def responses(*errors: type[ServiceError] | HTTPStatus) -> dict[int | str, dict[str, Any]]:
    """What an endpoint says of its errors in the OpenAPI document."""
    statuses = sorted({error if isinstance(error, HTTPStatus) else error.status for error in errors})
    content = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    return {int(status): {"description": _phrase(status), "content": content} for status in statuses}


def _phrase(status: int) -> str:
    return _OTHER_PHRASES.get(status) or HTTPStatus(status).phrase


def install(app: FastAPI) -> None:
    """Make `app` answer every error as a problem."""
    for kind, handler in _HANDLERS.items():
        app.add_exception_handler(kind, handler)


def _expected(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, DropflowError)  # noqa: S101 - registered for this kind
    return problem_response(problem_of(error), error.headers if isinstance(error, ServiceError) else None)


def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)  # noqa: S101 - registered for this kind
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        # The router names the methods of the first of several calls at one address.
        headers["Allow"] = allowed_methods(request.app.openapi(), request.url.path) or headers.get("Allow", "")
    return problem_response(http_problem(error), headers)


def http_problem(error: HTTPException) -> Problem:
    """What the framework found wrong with a request, in our words."""
    status = HTTPStatus(error.status_code)
    code = _CODES.get(status, f"request.{status.name.lower()}")
    return Problem(title=status.phrase, status=status, code=code, detail=_DETAILS.get(status, error.detail))


def _invalid(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - registered for this kind
    fields = [_field_problem(found) for found in error.errors()]
    return problem_response(problem_of(InvalidRequest("The request is not as expected.", fields=fields)))


def _field_problem(found: Mapping[str, Any]) -> FieldProblem:
    if found["type"] == "json_invalid":  # the place is a character's number then, no field
        reason = found.get("ctx", {}).get("error", "malformed")
        return FieldProblem("body", f"is not JSON: {reason} at character {found['loc'][-1]}")
    path = ".".join(str(part) for part in found["loc"][1:]) or str(found["loc"][0])
    return FieldProblem(path, str(found["msg"]).removeprefix("Value error, "))


class InvalidRequest(ServiceError):
    """The request itself (not the document in it) is malformed."""

    default_code = "request.invalid"
    status = HTTPStatus.UNPROCESSABLE_ENTITY


def _database_away(request: Request, error: Exception) -> JSONResponse:
    log.error("database away", path=request.url.path, reason=reason_of(error))
    status = HTTPStatus.SERVICE_UNAVAILABLE
    detail = "The database cannot be reached just now."
    problem = Problem(title=status.phrase, status=status, code="service.database_away", detail=detail)
    return problem_response(problem, {"Retry-After": "5"})


def _sender_gone(request: Request, _: Exception) -> JSONResponse:
    """Whoever sent this has broken off: nobody hears the answer, and nothing is wrong here."""
    log.info("request broken off", path=request.url.path, method=request.method)
    status = HTTPStatus.BAD_REQUEST
    return problem_response(
        Problem(title=status.phrase, status=status, code="request.broken_off", detail="The request was broken off.")
    )


def _bug(request: Request, error: Exception) -> JSONResponse:
    log.error("unexpected error", path=request.url.path, method=request.method, exc_info=error)
    status = HTTPStatus.INTERNAL_SERVER_ERROR
    detail = "Something went wrong here that was not expected. It was written to the service's log."
    return problem_response(Problem(title=status.phrase, status=status, code="service.internal", detail=detail))


_OTHER_PHRASES = {460: "Checksum Mismatch"}  # the protocol of uploads has it

_CODES = {
    HTTPStatus.NOT_FOUND: "not_found",
    HTTPStatus.METHOD_NOT_ALLOWED: "request.method_not_allowed",
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE: "request.too_large",
    HTTPStatus.BAD_REQUEST: "request.invalid",
}
_DETAILS = {
    HTTPStatus.NOT_FOUND: "There is nothing here.",
    HTTPStatus.METHOD_NOT_ALLOWED: "This cannot be done here.",
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE: "The request is larger than this service takes.",
}
_HANDLERS = {
    DropflowError: _expected,
    HTTPException: _http,
    RequestValidationError: _invalid,
    ClientDisconnect: _sender_gone,
    OperationalError: _database_away,
    PoolExhausted: _database_away,
    Exception: _bug,
}
