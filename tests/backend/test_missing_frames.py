"""Frames that cannot be read: an error with what to do, or, where the experiment allows it, gaps that results state."""

import io

import numpy as np
import pyarrow.parquet as pq

from tests.films import EXPERIMENT, Upload, film
from tests.house import House, Json

N_FRAMES, BROKEN = 10, (3, 6)


def _films() -> list[Upload]:
    files = film(N_FRAMES)
    return [
        Upload(file.name, file.content[: len(file.content) // 2] if index in BROKEN else file.content)
        for index, file in enumerate(files)
    ]


def _table(house: House, run: Json, name: str) -> list[dict[str, object]]:
    content = house.api.get(f"runs/{run['id']}/files/{name}").content
    return pq.read_table(io.BytesIO(content)).to_pylist()


def test_a_few_broken_frames_are_refused_kept_and_left_out_once_that_is_allowed(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *_films())
    refused = house.seal(experiment)
    problem = refused["stack"]["problem"]
    assert (refused["stack"]["state"], problem["code"], problem["frame"]) == ("rejected", "frames.truncated", 3)
    assert "max_failed_frame_share to 0.2" in problem["hint"]
    assert refused["stack"]["n_files"] == N_FRAMES
    document = {"experiment": {**EXPERIMENT, "max_failed_frame_share": 0.2}}
    house.ok(house.api.patch(f"experiments/{experiment['id']}", json=document))
    ready = house.seal(experiment)["stack"]
    assert (ready["state"], ready["n_frames"]) == ("ready", N_FRAMES - 2), ready["problem"]
    assert "2 frames cannot be read and are left out" in ready["warnings"][0]
    assert house.api.get(f"experiments/{experiment['id']}/frames/3.jpg").status_code == 200
    assert house.api.get(f"experiments/{experiment['id']}/frames/8.jpg").status_code == 404


def test_a_run_without_the_broken_frames_says_so_and_has_the_times_of_the_others_right(house: House) -> None:
    run = house.start(house.ready(_films(), max_failed_frame_share=0.2))
    house.work()
    run = house.again(run)
    assert run["state"] == "completed", run["problem"]
    assert run["summary"]["missing_frames"] == list(BROKEN)
    assert run["summary"]["provenance"]["missing_frames"] == list(BROKEN)
    assert "2 of 10 frames (20 %) could not be read" in run["warnings"][0]
    assert run["warnings"][0] in [warning["message"] for warning in run["summary"]["warnings"]]
    droplets = _table(house, run, "droplets.parquet")
    times_s = {row["frame"]: row["time_s"] for row in droplets}
    assert times_s == {0: 0.0, 1: 1.0, 2: 2.0, 3: 4.0, 4: 5.0, 5: 7.0, 6: 8.0, 7: 9.0}
    longest = max(np.unique([row["trajectory_id"] for row in _table(house, run, "trajectories.parquet")],
                            return_counts=True)[1])  # fmt: skip
    assert longest == N_FRAMES - 2  # droplets are followed over the gaps


def test_more_broken_frames_than_allowed_are_refused(house: House) -> None:
    experiment = house.experiment(max_failed_frame_share=0.1)
    house.upload(experiment, *_films())
    assert house.seal(experiment)["stack"]["problem"]["code"] == "frames.truncated"
