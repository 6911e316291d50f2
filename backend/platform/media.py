"""What kinds of content a call takes and gives: anything else is refused before anything is done."""

from email.message import Message
from http import HTTPStatus

from fastapi import Request
from fastapi.routing import APIRoute

from backend.platform.problems import ServiceError

JSON = "application/json"
ANYTHING = "*/*"


class NotAcceptable(ServiceError):
    """The asker takes nothing of what this call answers with."""

    default_code = "request.not_acceptable"
    status = HTTPStatus.NOT_ACCEPTABLE


class NotJson(ServiceError):
    """The body is of another kind than this call takes."""

    default_code = "request.unsupported_media_type"
    status = HTTPStatus.UNSUPPORTED_MEDIA_TYPE


def check_media(request: Request) -> None:
    """Raise `NotAcceptable` or `NotJson` where the request's `Accept` or `Content-Type` fits nothing."""
    route = request.scope.get("route")
    if not isinstance(route, APIRoute):
        return
    given = answers_of(route)
    accept = ",".join(request.headers.getlist("accept"))
    if accept and ANYTHING not in given and not any(is_accepted(accept, kind) for kind in given):
        raise NotAcceptable(f"This call answers with {' or '.join(sorted(given))}.", hint="Change the header Accept.")
    if route.body_field is not None and _has_body(request) and not is_json(request.headers.get("content-type", "")):
        raise NotJson("This call takes JSON.", hint=f"Send it with the header Content-Type: {JSON}.")


def answers_of(route: APIRoute) -> set[str]:
    """The kinds of content that a call answers with when all is well."""
    documented = {
        kind
        for status, answer in route.responses.items()
        if str(status).startswith("2")
        for kind in answer.get("content", {})
    }
    made = getattr(getattr(route.response_class, "value", route.response_class), "media_type", None)
    return documented or ({made} if made else {JSON})


def is_accepted(accept: str, kind: str) -> bool:
    """Whether `Accept` names `kind`, alone or with others of its family, and does not rule it out (`q=0`)."""
    family = kind.partition("/")[0]
    best = (-1, 0.0)
    for entry in accept.split(","):
        named, quality = _weighed(entry)
        if named in (kind, f"{family}/*", "*/*", "*"):
            best = max(best, (len(named) if named == kind else named.count("/") - named.count("*"), quality))
    return best[1] > 0


def is_json(content_type: str) -> bool:
    """Whether the framework reads a body of this kind as JSON."""
    message = Message()
    message["content-type"] = content_type
    kind = message.get_content_type()
    return kind == JSON or (kind.startswith("application/") and kind.endswith("+json"))


def _weighed(entry: str) -> tuple[str, float]:
    named, *parameters = (part.strip().lower() for part in entry.split(";"))
    for parameter in parameters:
        if parameter.startswith("q="):
            try:
                return named, float(parameter[2:])
            except ValueError:
                return named, 0.0
    return named, 1.0


def _has_body(request: Request) -> bool:
    return request.headers.get("content-length", "0") != "0" or "transfer-encoding" in request.headers
