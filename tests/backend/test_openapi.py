"""The API's description of itself."""

import json
from typing import Any

import jsonschema
import pytest

from backend.app import bare_app
from tests.services import ROOT

DOCUMENT = bare_app().openapi()
OPERATIONS = [
    (method, path, operation) for path, methods in DOCUMENT["paths"].items() for method, operation in methods.items()
]


def test_the_page_s_client_is_made_from_this_very_api() -> None:
    kept = (ROOT / "frontend" / "openapi.json").read_text(encoding="utf-8")
    made = json.dumps(DOCUMENT, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
    assert kept == made, "run: python -m backend.openapi > frontend/openapi.json"


@pytest.mark.parametrize(("method", "path", "operation"), OPERATIONS)
def test_every_operation_says_what_it_does_and_how_it_fails(
    method: str, path: str, operation: dict[str, object]
) -> None:
    noun, _, verb = str(operation["operationId"]).partition("_")
    assert noun.isidentifier()
    assert verb
    assert operation["description"]
    responses = operation["responses"]
    assert isinstance(responses, dict)
    assert "application/problem+json" in responses["default"]["content"]
    assert any(status.startswith(("2", "3")) for status in responses)
    if "{" in path:
        assert {"404", "422"} <= set(responses)
    if method in {"post", "patch"} and "requestBody" in operation:
        assert "422" in responses


def test_operations_have_names_of_their_own() -> None:
    names = [operation["operationId"] for _, _, operation in OPERATIONS]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(("method", "path", "operation"), OPERATIONS)
def test_every_call_shows_an_example_that_its_schema_allows(method: str, path: str, operation: dict[str, Any]) -> None:
    contents = [
        content
        for body in (operation.get("requestBody", {}), *operation["responses"].values())
        for kind, content in body.get("content", {}).items()
        if kind == "application/json" and content.get("schema")
    ]
    for shown in [*operation.get("parameters", []), *contents]:
        example = shown["example"] if "example" in shown else shown["examples"][0]
        jsonschema.validate(example, {**shown["schema"], "components": DOCUMENT["components"]})


def test_what_a_call_makes_is_linked_to_the_calls_that_take_it() -> None:
    links = DOCUMENT["paths"]["/api/v1/experiments"]["post"]["responses"]["201"]["links"]
    assert {"experiments_get", "files_upload", "stack_complete", "runs_create"} <= set(links)
    links = DOCUMENT["paths"]["/api/v1/experiments/{experiment_id}/runs"]["post"]["responses"]["202"]["links"]
    assert {"runs_get", "runs_cancel", "figures_get", "result_files_download"} <= set(links)


def test_the_main_calls_show_an_example_of_their_own() -> None:
    schemas = DOCUMENT["components"]["schemas"]
    for name in ("NewExperiment", "NewRun", "ChangeExperiment"):
        assert schemas[name]["examples"]
