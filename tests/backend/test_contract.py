"""Schemathesis over the whole OpenAPI document, calls linked by what they answer: nothing breaks, nothing surprises.

Each failure is printed with the `curl` that shows it again.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from backend.platform.settings import Settings
from tests.house import House, open_house
from tests.services import ROOT

# Streams that end with what they follow, which nobody ends here (tests/backend/test_events.py follows them); and what
# waits for a worker, of which there is none here: it answers 503 after a while, as it says, and the minute is over.
LEFT_OUT = r"/(events|previews|suggestions|detection|prepared\.jpg)(/|$)"
# What a schema cannot say (that a cursor must be of this list, a name of the material one that is known) is refused
# with 422, and rightly so. This service is that of one machine, which lets all its programs in: who may do what is
# asked of every call in tests/backend/test_rights.py.
UNFIT_CHECKS = "positive_data_acceptance,ignored_auth"

# Requests that violate their schema are refused with one of these; 412 and 460 are those of tus.
CONFIGURATION = """
hooks = "tests.backend.schemathesis_hooks"
[checks.negative_data_rejection]
expected-statuses = [400, 401, 403, 404, 405, 406, 409, 412, 413, 415, 416, 422, 423, 460]
"""


@pytest.mark.timeout(180)
def test_a_minute_of_any_calls_breaks_nothing(settings: Settings, tmp_path: Path) -> None:
    with open_house(settings) as house:
        _try_everything(house, tmp_path, seconds=60, seed="1")


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_ten_minutes_of_any_calls_break_nothing(settings: Settings, tmp_path: Path) -> None:
    with open_house(settings) as house:
        _try_everything(house, tmp_path, seconds=600)


def _try_everything(house: House, folder: Path, *, seconds: int, seed: str | None = None) -> None:
    schema = folder / "openapi.json"
    schema.write_text(json.dumps(_strict(house)), encoding="utf-8")
    (folder / "schemathesis.toml").write_text(CONFIGURATION, encoding="utf-8")
    command = [
        Path(sys.executable).with_name("st"),
        *("run", schema, "--url", str(house.api.base_url).removesuffix("/api/v1/")),
        *("--max-time", str(seconds), "--request-timeout", "30", "--suppress-health-check", "all"),
        *("--exclude-checks", UNFIT_CHECKS, "--continue-on-failure", "--warnings", "off"),
        *("--exclude-path-regex", LEFT_OUT),
        *(("--seed", seed) if seed else ()),
    ]
    environment = os.environ | {"NO_COLOR": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{done.stdout[-20_000:]}\n{done.stderr[-2000:]}"
    assert " generated" in done.stdout


def _strict(house: House) -> dict[str, Any]:
    """The document, without its excuse for statuses that are not named, and with things that are really there."""
    run = house.start(house.ready())
    house.work()
    document: dict[str, Any] = house.ok(house.api.get("openapi.json"))
    # Without a word of tokens: made-up ones would be refused, and after sixty a minute nothing else would be seen.
    document["components"].pop("securitySchemes", None)
    document.pop("security", None)
    known = {"experiment_id": run["experiment_id"], "run_id": run["id"], "name": None}
    for methods in document["paths"].values():
        for operation in methods.values():
            operation["responses"].pop("default")
            operation.pop("security", None)
            for parameter in operation.get("parameters", []):
                if parameter["in"] == "path" and known.get(parameter["name"]):
                    parameter["example"] = known[parameter["name"]]
    _spell_out(document, "experiment", house, "NewExperiment", "ChangeExperiment")
    _spell_out(document, "parameters", house, "NewRun")
    return document


def _spell_out(document: dict[str, Any], field: str, house: House, *bodies: str) -> None:
    """Say what documents are made of, so that most of those that are made up here are valid."""
    schema = house.ok(house.api.get(f"schemas/{field}"))
    text = json.dumps(schema).replace("#/$defs/", "#/components/schemas/")
    schema = json.loads(text)
    document["components"]["schemas"] |= schema.pop("$defs", {})
    for body in bodies:
        document["components"]["schemas"][body]["properties"][field] = schema


def test_the_committed_document_is_the_one_that_is_served(house: House) -> None:
    kept = json.loads((ROOT / "frontend" / "openapi.json").read_text(encoding="utf-8"))
    assert house.ok(house.api.get("openapi.json")) == kept
