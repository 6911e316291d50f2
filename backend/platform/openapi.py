"""The API's own description, the same bytes for the same code.

What is true of every call (how it refuses, what it answers to an `ETag`) is written here once, not at each endpoint.
"""

from collections.abc import Iterator
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from backend.platform.examples import add_examples
from backend.platform.links import add_links
from backend.platform.problems import MEDIA_TYPE

JSON = "application/json"
Json = dict[str, Any]


def document(app: FastAPI) -> dict[str, Any]:
    """The OpenAPI document: FastAPI's, and what all calls have in common."""
    if app.openapi_schema is None:
        made = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
        for method, _, operation in operations(made):
            _add_common_answers(method, operation)
        add_examples(made)
        add_links(made)
        app.openapi_schema = made
    return app.openapi_schema


def operations(made: Json) -> Iterator[tuple[str, str, Json]]:
    """Method, path and description of every call."""
    for path, methods in made["paths"].items():
        for method, operation in methods.items():
            yield method, path, operation


def _add_common_answers(method: str, operation: Json) -> None:
    answers: Json = operation["responses"]
    wanted = [HTTPStatus.NOT_ACCEPTABLE]
    if "security" in operation:
        wanted += [HTTPStatus.UNAUTHORIZED, HTTPStatus.FORBIDDEN, HTTPStatus.TOO_MANY_REQUESTS]
    if JSON in operation.get("requestBody", {}).get("content", {}):
        wanted += [HTTPStatus.BAD_REQUEST, HTTPStatus.REQUEST_ENTITY_TOO_LARGE, HTTPStatus.UNSUPPORTED_MEDIA_TYPE]
    for status in wanted:
        answers.setdefault(str(int(status)), _problem(status.phrase))
    if method == "get" and JSON in answers.get("200", {}).get("content", {}):
        answers.setdefault("304", {"description": "It is what you have: the `ETag` that `If-None-Match` names."})
    answers.setdefault("default", _problem("What went wrong, and what to do."))


def _problem(description: str) -> Json:
    schema = {"$ref": "#/components/schemas/Problem"}
    return {"description": description, "content": {MEDIA_TYPE: {"schema": schema}}}
