"""Whoever names a collector gets traces of requests and shards, by run; whoever does not, nothing."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from pydantic import ValidationError

from backend.platform.settings import Settings
from deploy.local.valkey import Valkey
from tests.collector import Collector, running_collector
from tests.films import EXPERIMENT, PARAMETERS, film
from tests.house import House, open_house
from tests.services import ROOT, running_service


@pytest.fixture
def collector() -> Iterator[Collector]:
    with running_collector() as running:
        yield running


def test_requests_and_shards_arrive_with_the_ids_of_their_run(settings: Settings, collector: Collector) -> None:
    traced = settings.model_copy(update={"otel_exporter_otlp_endpoint": collector.url})
    with open_house(traced) as house:
        run = house.start(house.ready())
        house.work()
        assert house.again(run)["state"] == "completed"
        house.api.get("runs/00000000-0000-0000-0000-000000000000?key=secret")
    # What was not sent yet is sent when the service stops.
    asked = [span for span in collector.spans if span.attributes.get("dropflow.run") == run["id"]]
    names = {span.name for span in asked}
    assert {"shard prepare", "shard detect", "shard track", "shard analyse"} <= names
    assert "GET /api/v1/runs/{run_id}" in names
    assert all(span.attributes["dropflow.shard"] for span in asked if span.name.startswith("shard"))
    assert not any("secret" in value for span in collector.spans for value in span.attributes.values())


def test_a_shard_that_fails_is_marked(settings: Settings, collector: Collector) -> None:
    traced = settings.model_copy(update={"otel_exporter_otlp_endpoint": collector.url})
    with open_house(traced) as house:
        experiment = house.ready()
        house.start(experiment)
        frames = house.objects / "experiments" / experiment["id"] / "files"
        for file in frames.iterdir():
            file.write_bytes(b"no image any more")
        house.work()
    assert any(span.is_error for span in collector.spans if span.name.startswith("shard"))


def test_a_collector_that_is_away_harms_nothing(settings: Settings) -> None:
    away = settings.model_copy(update={"otel_exporter_otlp_endpoint": "http://127.0.0.1:1"})
    with open_house(away) as house:
        run = house.start(house.ready())
        house.work()
        assert house.again(run)["state"] == "completed"


def test_without_a_collector_nothing_is_loaded() -> None:
    program = (
        "import sys; from backend.platform.tracing import carrier, span, start_tracing\n"
        "start_tracing(None, 'x')\n"
        "with span('y', {}): assert carrier() == {}\n"
        "print([name for name in sys.modules if name.startswith('opentelemetry.sdk')])"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_an_address_that_is_none_is_refused(settings: Settings) -> None:
    given = settings.model_dump()
    assert Settings(**given | {"otel_exporter_otlp_endpoint": ""}).otel_exporter_otlp_endpoint is None
    with pytest.raises(ValidationError, match="such as http://"):
        Settings(**given | {"otel_exporter_otlp_endpoint": "collector:4318"})


def _json_lines(file: Path) -> list[dict[str, str]]:
    return [json.loads(line) for line in file.read_text().splitlines() if line.startswith("{")]


@pytest.mark.slow
def test_processes_of_their_own_send_traces_and_name_the_run_in_their_logs(
    database_url: str, valkey_server: Valkey, collector: Collector
) -> None:
    settings = {"OTEL_EXPORTER_OTLP_ENDPOINT": collector.url, "OTEL_BSP_SCHEDULE_DELAY": "200", "LOG_LEVEL": "DEBUG"}
    with running_service(database_url, valkey_server.url(4), **settings) as service:
        with httpx.Client(base_url=f"{service.url}api/v1/", timeout=30) as api:
            house = House(app=None, api=api, context=None, objects=Path())  # type: ignore[arg-type]
            experiment = house.ok(api.post("experiments", json={"experiment": EXPERIMENT}), 201)
            house.upload(experiment, *film())
            house.ok(api.post(f"experiments/{experiment['id']}/stack"), 202)
            deadline = time.monotonic() + 60
            while house.again(experiment)["stack"]["state"] != "ready":
                assert time.monotonic() < deadline
                time.sleep(0.1)
            run = house.start(experiment, PARAMETERS)
            house.ok(api.post(f"experiments/{experiment['id']}/previews", json={"frame": 0, "parameters": PARAMETERS}))
            detected = collector.await_span(
                lambda span: span.name == "shard detect" and span.attributes["dropflow.run"] == run["id"], 120
            )
            assert detected.service == "dropflow-worker"
            preview = collector.await_span(lambda span: span.name == "preview droplets")
            assert preview.parent_id
            asked = collector.await_span(lambda span: span.name.startswith("POST") and "previews" in span.name)
            assert (asked.service, asked.trace_id) == ("dropflow-api", preview.trace_id)
        lines = [line for file in service.logs.glob("worker*.log") for line in _json_lines(file)]
        told = [line for line in lines if line.get("event") == "shard left" and line.get("run") == run["id"]]
        assert {"shard", "experiment", "task", "trace"} <= told[0].keys()
        asked_lines = [line for file in service.logs.glob("api*.log") for line in _json_lines(file)]
        assert any(
            line.get("event") == "request" and line.get("experiment") == experiment["id"] for line in asked_lines
        )
