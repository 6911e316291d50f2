"""`python -m deploy.local.demo ADDRESS`: an experiment to look at, simulated here and sent as anybody would send one.

It is found again by its tag, so that it is made once; what an interrupted start left half done is completed.
"""

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import yaml

from dropflow.errors import DropflowError
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import changed, named_scenario
from dropflow.simulation.write import write_experiment

TAG = "dropflow-demo"
NAME = "Demo: simulated droplets that grow"
NOTE = "Simulated at the first start of Dropflow. Delete it when you have seen enough; it does not come back."
SCENARIO, SEED, N_FRAMES = "easy", 1, 60
# Droplets enough to fill a size distribution, and growth that is seen within half a minute of film.
CONSTANTS = {"height_px": 512, "width_px": 612, "n_droplets": 800.0, "growth_um_s": 0.08}
INDEX_TIMEOUT_S = 300.0


class DemoError(Exception):
    """The service did not take it."""


def send_demo(client: httpx.Client, *, n_frames: int = N_FRAMES) -> str:
    """Bring the demo as far as a run; the id of its experiment."""
    experiment = _known(client) or _create(client)
    url = f"experiments/{experiment['id']}"
    if experiment["stack"]["state"] in ("empty", "uploading", "rejected"):
        _upload(client, url, n_frames)
    _await_ready(client, url)
    if _asked(client.get(url))["n_runs"] == 0:
        _asked(client.post(f"{url}/runs", json={"parameters": {}}))
    return str(experiment["id"])


def _known(client: httpx.Client) -> dict[str, Any] | None:
    return next((found for found in _experiments(client) if TAG in found["experiment"].get("tags", [])), None)


def _experiments(client: httpx.Client) -> Iterator[dict[str, Any]]:
    cursor: str | None = ""
    while cursor is not None:
        page = _asked(client.get("experiments", params={"cursor": cursor} if cursor else {}))
        yield from page["items"]
        cursor = page["next_cursor"]


def _create(client: httpx.Client) -> dict[str, Any]:
    scenario = changed(named_scenario(SCENARIO), CONSTANTS)
    document = scenario.experiment(seed=SEED, is_with_flat_field=True).model_dump(mode="json", exclude_none=True)
    document |= {"name": NAME, "notes": NOTE, "tags": [TAG]}
    return _asked(client.post("experiments", json={"experiment": document}))


def _upload(client: httpx.Client, url: str, n_frames: int) -> None:
    with tempfile.TemporaryDirectory(prefix="dropflow-demo-") as scratch:
        film = Path(scratch) / "film"
        write_experiment(film, Film(changed(named_scenario(SCENARIO), CONSTANTS), SEED), n_frames)
        flat_field = yaml.safe_load((film / "experiment.yaml").read_text())["flat_field"]
        files = [
            (film / flat_field, "flat_field"),
            *((frame, "frames") for frame in sorted((film / "frames").iterdir())),
        ]
        for file, role in files:
            _asked(client.put(f"{url}/files", params={"name": file.name, "role": role}, content=file.read_bytes()))
    _asked(client.post(f"{url}/stack"))


def _await_ready(client: httpx.Client, url: str) -> None:
    deadline = time.monotonic() + INDEX_TIMEOUT_S
    while time.monotonic() < deadline:
        stack = _asked(client.get(url))["stack"]
        if stack["state"] == "ready":
            return
        if stack["state"] != "indexing":
            raise DemoError(f"its frames were {stack['state']}: {(stack['problem'] or {}).get('detail')}")
        time.sleep(0.5)
    raise DemoError(f"its frames were not read within {INDEX_TIMEOUT_S:.0f} s")


def _asked(response: httpx.Response) -> dict[str, Any]:
    if response.is_error:
        raise DemoError(
            f"{response.request.method} {response.request.url.path}: {response.status_code} {response.text}"
        )
    return dict(response.json())


def main() -> int:
    """Send it; one line and exit code 1 where that fails."""
    try:
        token = os.environ.get("LOCAL_TOKEN")
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        with httpx.Client(base_url=f"{sys.argv[1]}api/v1/", headers=headers, timeout=60, trust_env=False) as client:
            send_demo(client)
    except (DemoError, DropflowError, httpx.HTTPError) as problem:
        print(problem, file=sys.stderr)  # noqa: T201 - the launcher shows it
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
