"""The demo goes through the public API, is made once, and an interrupted one is completed."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from deploy.local.demo import CONSTANTS, SCENARIO, SEED, TAG, send_demo
from dropflow.simulation.scenario import changed, named_scenario
from tests.services import RunningService

N_FRAMES = 4


@pytest.fixture
def client(service: RunningService) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=f"{service.url}api/v1/", timeout=60, trust_env=False) as opened:
        yield opened


def demos(client: httpx.Client) -> list[dict[str, Any]]:
    items = client.get("experiments").raise_for_status().json()["items"]
    return [item for item in items if TAG in item["experiment"]["tags"]]


def test_an_interrupted_demo_is_completed_and_made_once(client: httpx.Client) -> None:
    scenario = changed(named_scenario(SCENARIO), CONSTANTS)
    document = scenario.experiment(seed=SEED).model_dump(mode="json", exclude_none=True) | {"tags": [TAG]}
    begun = client.post("experiments", json={"experiment": document}).raise_for_status().json()
    assert send_demo(client, n_frames=N_FRAMES) == begun["id"]
    assert send_demo(client, n_frames=N_FRAMES) == begun["id"]
    (demo,) = demos(client)
    assert demo["stack"]["n_frames"] == N_FRAMES
    assert demo["n_runs"] == 1
