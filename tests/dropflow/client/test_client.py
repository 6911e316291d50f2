"""The Python client against a running service with workers."""

from contextlib import suppress
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
import polars as pl
import pytest

from dropflow.client import Client, ClientError, Damaged, NotReachable, Run, ServerProblem, TimedOut, WentWrong
from dropflow.client.downloads import sha256_of
from dropflow.results import open_results
from tests.films import N_FRAMES, PARAMETERS, frame, tiff
from tests.services import RunningService


class Seen:
    """Progress that is kept."""

    def __init__(self) -> None:
        self.stages: dict[str, tuple[int, int]] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        assert 0 <= done <= total
        self.stages[stage] = (done, total)


def _submit(client: Client, stack: Path, **about: Any) -> Run:
    return client.submit(stack, stack.parent / "experiment.yaml", parameters=PARAMETERS, **about)


def test_from_a_folder_to_tables_flow_and_figures(client: Client, stack: Path, tmp_path: Path) -> None:
    seen = Seen()
    run = _submit(client, stack, progress=seen).wait(progress=seen)
    size_bytes = sum(file.stat().st_size for file in stack.iterdir())
    assert seen.stages == {
        "upload": (size_bytes, size_bytes),
        **dict.fromkeys(("index", "detect", "track", "analyse"), (N_FRAMES, N_FRAMES)),
    }
    assert run.state == "completed"
    assert run.summary is not None
    assert run.droplets().height == run.summary["detected"]["n_droplets"]
    trajectories = run.trajectories()
    assert isinstance(trajectories, pl.DataFrame)
    assert {"trajectory_id", "r_um", "u_um_s"} <= set(trajectories.columns)
    assert run.rejected_trajectories().height >= 0
    flow = run.flow()
    assert flow["velocity_um_s"].dims == ("frame", "component", "row", "column")
    assert flow["velocity_um_s"].shape == (N_FRAMES - 1, 2, 4, 5)
    assert flow["velocity_um_s"].attrs["units"] == "um/s"
    figure = run.figure("moments")
    assert isinstance(figure, go.Figure)
    assert len(figure.data) > 0
    folder = run.fetch(tmp_path / "results")
    assert open_results(folder).summary == run.summary
    assert not list(folder.glob(".*"))


def test_the_same_film_again_is_the_same_experiment_and_run(client: Client, stack: Path) -> None:
    first, second = _submit(client, stack), _submit(client, stack)
    assert first.is_new
    assert not second.is_new
    assert first.id == second.id
    other = client.submit(stack, stack.parent / "experiment.yaml", parameters=PARAMETERS | {"flow": {"n_columns": 6}})
    assert other.id != first.id
    assert other.document.experiment_id == first.document.experiment_id
    again = _submit(client, stack, is_again=True)
    assert again.document.experiment_id != first.document.experiment_id


def test_a_cancelled_run_or_a_deleted_experiment_is_made_anew(client: Client, stack: Path) -> None:
    experiment = client.film(stack, stack.parent / "experiment.yaml")
    run = experiment.start_once({"detection": PARAMETERS["detection"]})
    with suppress(ServerProblem):  # it may be quicker than we
        run.cancel()
    if run.refresh().state == "completed":
        run.delete()
    else:
        with pytest.raises(WentWrong, match="cancelled"):
            run.wait(timeout_s=60)
    second = experiment.start_once({"detection": PARAMETERS["detection"]})
    assert second.id != run.id
    second.wait(timeout_s=120)
    experiment.delete()
    assert client.film(stack, stack.parent / "experiment.yaml").id != experiment.id


def test_frames_that_cannot_be_used_are_named(client: Client, stack: Path) -> None:
    (stack / "frame3.tif").write_bytes(tiff(frame(3))[:5000])
    with pytest.raises(WentWrong, match=r"frame3\.tif") as raised:
        _submit(client, stack)
    assert raised.value.code.startswith("frames.")


def test_a_film_that_was_mended_is_taken_though_its_files_are_as_large(client: Client, stack: Path) -> None:
    good = (stack / "frame2.tif").read_bytes()
    (stack / "frame2.tif").write_bytes(b"II*\0" + b"\xff" * (len(good) - 4))
    with pytest.raises(ClientError):
        _submit(client, stack)
    (stack / "frame2.tif").write_bytes(good)
    assert _submit(client, stack).wait(timeout_s=120).state == "completed"


def test_a_lost_update_is_told(client: Client, stack: Path) -> None:
    mine = client.experiments.create(stack.parent / "experiment.yaml")
    theirs = client.experiments.get(mine.id)
    theirs.change(theirs.document.experiment | {"name": "theirs"})
    with pytest.raises(ServerProblem, match="somebody else") as raised:
        mine.change(mine.document.experiment | {"name": "mine"})
    assert raised.value.status == 412
    assert mine.refresh().change(mine.document.experiment | {"name": "mine"}).name == "mine"


def test_lists_are_asked_for_page_by_page(client: Client, stack: Path) -> None:
    made = client.experiments.create(stack.parent / "experiment.yaml")
    (found,) = client.experiments.list(q=made.name)
    assert found.id == made.id
    assert list(found.runs()) == []
    assert all(run.state == "failed" for run in client.runs.list(state="failed"))


def test_the_server_s_problem_is_the_error(client: Client) -> None:
    with pytest.raises(ServerProblem) as raised:
        client.runs.get("00000000-0000-4000-8000-00000000dead")
    assert (raised.value.status, raised.value.code) == (404, "not_found.run")


def test_results_are_not_there_before_the_run_is_over(client: Client, stack: Path, tmp_path: Path) -> None:
    run = _submit(client, stack)
    if not run.refresh().document.is_over:
        with pytest.raises(WentWrong, match="Wait for its end"):
            run.fetch(tmp_path / "early")
    with pytest.raises(TimedOut):
        client.experiments.get(run.document.experiment_id).start({}).wait(timeout_s=0)
    run.wait(timeout_s=120)


def test_a_cut_download_goes_on_and_a_damaged_one_begins_anew(client: Client, stack: Path, tmp_path: Path) -> None:
    run = _submit(client, stack).wait(timeout_s=120)
    whole = run.download("trajectories.parquet", tmp_path / "whole.parquet")
    content, checksum = whole.read_bytes(), sha256_of(whole)
    tag = client._connection.request("GET", f"runs/{run.id}/files/trajectories.parquet").headers["ETag"]
    for name, beginning in (("cut", content[:1000]), ("damaged", b"x" * 1000), ("complete", content)):
        target = tmp_path / f"{name}.parquet"
        (tmp_path / f".{name}.parquet.part").write_bytes(beginning)
        (tmp_path / f".{name}.parquet.tag").write_text(tag)
        seen = Seen()
        assert sha256_of(run.download("trajectories.parquet", target, progress=seen)) == checksum
    assert sorted(path.name for path in tmp_path.glob(".*")) == []


def test_a_server_that_is_none_is_said_to_be_none(service: RunningService, tmp_path: Path) -> None:
    with pytest.raises(NotReachable, match="cannot be reached"):
        Client("http://127.0.0.1:1/")
    with pytest.raises((NotReachable, ServerProblem)):
        Client(f"{service.url}assets/")
    assert issubclass(Damaged, ClientError)
