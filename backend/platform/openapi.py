"""The API's own description, the same bytes for the same code."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from backend.platform.problems import MEDIA_TYPE


def document(app: FastAPI) -> dict[str, Any]:
    """The OpenAPI document: FastAPI's, and that everything else is answered as a problem."""
    if app.openapi_schema is None:
        made = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
        problem = {
            "description": "What went wrong, and what to do.",
            "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
        }
        for path in made["paths"].values():
            for operation in path.values():
                operation["responses"].setdefault("default", problem)
        app.openapi_schema = made
    return app.openapi_schema
