"""The API's description of itself."""

import json

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
    assert any(status.startswith("2") for status in responses)
    if "{" in path:
        assert {"404", "422"} <= set(responses)
    if method in {"post", "patch"} and "requestBody" in operation:
        assert "422" in responses


def test_operations_have_names_of_their_own() -> None:
    names = [operation["operationId"] for _, _, operation in OPERATIONS]
    assert len(set(names)) == len(names)


def test_the_main_calls_show_an_example() -> None:
    schemas = DOCUMENT["components"]["schemas"]
    for name in ("NewExperiment", "NewRun", "ChangeExperiment"):
        assert schemas[name]["examples"]
