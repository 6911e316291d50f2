"""Measures tell the true state of the service, and health is told apart from readiness."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families as families

from backend.platform.settings import Settings
from deploy.local.processes import free_port
from tests.house import House, open_house
from worker.leases import claim
from worker.reconcile import expire_leases


@pytest.fixture
def measured(settings: Settings) -> Iterator[House]:
    address = f"127.0.0.1:{free_port()}"
    with open_house(settings.model_copy(update={"metrics_address": address})) as house:
        yield house


def sample(house: House, name: str, **labels: str) -> float:
    answer = httpx.get(f"http://{house.app.state.platform.settings.metrics_address}/metrics")
    found = [
        s.value
        for family in families(answer.text)
        for s in family.samples
        if s.name == name and labels.items() <= s.labels.items()
    ]
    assert found, f"no {name} {labels} in\n{answer.text}"
    return sum(found)


def test_queue_runs_and_what_was_done_are_measured(measured: House) -> None:
    run = measured.start(measured.ready())
    assert sample(measured, "dropflow_runs", state="queued") == 1
    assert sample(measured, "dropflow_queue_depth") >= 1
    measured.work()
    assert measured.again(run)["state"] == "completed"
    assert sample(measured, "dropflow_runs", state="completed") == 1
    assert sample(measured, "dropflow_shard_seconds", task="detect") > 0
    assert sample(measured, "dropflow_frames_per_second", task="detect") > 0
    assert sample(measured, "dropflow_received_bytes_total") > 10_000
    assert sample(measured, "dropflow_request_seconds_count", method="POST", status="202") >= 2


def test_expired_leases_are_counted(measured: House) -> None:
    measured.start(measured.ready())
    with measured.context.sessions.begin() as session:
        assert claim(session, measured.waiting()[0], holder="one that dies", lease_s=0.0)
    expire_leases(measured.context)
    assert sample(measured, "dropflow_lease_expiries_total") == 1


def test_live_streams_are_counted_while_they_last(measured: House) -> None:
    experiment = measured.experiment()
    with measured.api.stream("GET", f"experiments/{experiment['id']}/events") as stream:
        lines = stream.iter_lines()
        next(lines)
        assert sample(measured, "dropflow_live_streams") == 1


def test_measures_are_not_served_beside_the_api(measured: House) -> None:
    base = str(measured.api.base_url).removesuffix("/api/v1/")
    assert "dropflow_runs" not in httpx.get(f"{base}/metrics").text


def test_a_service_without_its_store_is_alive_but_not_ready(measured: House, tmp_path: Path) -> None:
    base = str(measured.api.base_url).removesuffix("/api/v1/")
    assert httpx.get(f"{base}/readyz").status_code == 200
    measured.objects.rename(tmp_path / "elsewhere")
    away = httpx.get(f"{base}/readyz")
    assert (away.status_code, away.json()["object_store"]) == (503, "away")
    assert httpx.get(f"{base}/healthz").status_code == 200


def test_a_measures_address_that_is_none_is_refused(settings: Settings) -> None:
    with pytest.raises(ValueError, match="host:port"):
        Settings(**settings.model_dump() | {"metrics_address": "9100"})
