"""What cannot be done ends with its cause in plain words; what may be passing is tried again."""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError

from backend.models.states import ShardState
from dropflow import pipeline
from tests.films import Upload, film, frame, tiff
from tests.house import House, Json
from worker import analyse, detect, outcomes, prepare, track
from worker.leases import MAX_ERRORS, claim
from worker.shards import look_at


def _kept(house: House, experiment: Json) -> Path:
    return house.objects / "experiments" / experiment["id"] / "files"


def test_a_frame_that_broke_after_the_index_fails_the_run_and_names_file_and_frame(house: House) -> None:
    experiment = house.ready()
    run = house.start(experiment)
    for kept in _kept(house, experiment).iterdir():
        kept.write_bytes(kept.read_bytes()[:500])
    house.work()
    failed = house.again(run)
    assert failed["state"] == "failed"
    assert failed["problem"]["code"] == "frames.truncated"
    assert failed["problem"]["file"] == "frames/frame0.tif"
    assert failed["summary"] is None
    assert house.waiting() == []


def test_what_others_do_of_a_failed_run_does_not_count_and_is_not_kept(house: House) -> None:
    experiment = house.ready()
    run = house.start(experiment)
    look_at(house.context, house.waiting("prepare")[0])
    waiting = house.waiting("detect")
    with house.context.sessions.begin() as session:
        taken = claim(session, waiting[5], holder="slow", lease_s=60)
    assert taken is not None
    for kept in _kept(house, experiment).iterdir():
        kept.write_bytes(b"II*\0 broken")
    house.work()
    states = [shard.state for shard in house.shards(run) if shard.task == "detect"]
    assert states == [ShardState.FAILED, *[ShardState.CANCELLED] * 5]


def test_an_unexpected_error_is_tried_three_times_and_then_told(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    tries = []

    def broken(*_: object, **__: object) -> None:
        tries.append(1)
        raise RuntimeError("/srv/secret/place is broken")

    run = house.start(house.ready())
    monkeypatch.setattr(pipeline, "estimate", broken)
    (shard_id,) = house.waiting("prepare")
    for n_errors in range(1, MAX_ERRORS + 1):
        assert house.again(run)["state"] in {"queued", "running"}
        look_at(house.context, shard_id)
        assert len(tries) == n_errors
    failed = house.again(run)
    assert failed["state"] == "failed"
    assert failed["problem"]["code"] == "run.internal"
    assert "RuntimeError" in failed["problem"]["detail"]
    assert "prepare" in failed["problem"]["detail"]
    assert str(shard_id) in failed["problem"]["hint"]


def test_what_an_unexpected_error_says_of_the_server_is_not_shown(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = house.start(house.ready())
    missing = FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), "/srv/secret/place")
    monkeypatch.setattr(pipeline, "estimate", _raising(missing))
    for _ in range(MAX_ERRORS):
        look_at(house.context, house.waiting("prepare")[0])
    answer = house.api.get(f"runs/{run['id']}").text
    assert "FileNotFoundError" in answer
    assert "secret" not in answer


@pytest.mark.parametrize(
    "full",
    [
        OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/srv/objects/x"),
        OSError("Generic LocalFileSystem error: No space left on device (os error 28)"),
    ],
)
def test_a_full_disk_is_told_in_plain_words(house: House, monkeypatch: pytest.MonkeyPatch, full: OSError) -> None:
    run = house.start(house.ready())
    monkeypatch.setattr(pipeline, "estimate", _raising(full))
    for _ in range(MAX_ERRORS):
        look_at(house.context, house.waiting("prepare")[0])
    problem = house.again(run)["problem"]
    assert (problem["code"], problem["status"]) == ("run.no_space", 507)
    assert "space" in problem["detail"]


def _raising(error: Exception) -> Callable[..., None]:
    def broken(*_: object, **__: object) -> None:
        raise error

    return broken


def test_an_unexpected_error_that_passes_leaves_no_trace(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    run = house.start(house.ready())
    with monkeypatch.context() as broken:
        broken.setattr(pipeline, "estimate", lambda *_, **__: 1 / 0)
        look_at(house.context, house.waiting("prepare")[0])
    house.work()
    done = house.again(run)
    assert (done["state"], done["problem"]) == ("completed", None)


def test_a_fault_of_ours_while_indexing_keeps_the_files_so_that_it_can_be_tried_again(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film())
    house.ok(house.api.post(f"experiments/{experiment['id']}/stack"), 202)
    with monkeypatch.context() as broken:
        broken.setattr("worker.ingest.check_frames", lambda *_, **__: 1 / 0)
        (shard_id,) = house.waiting()
        for _ in range(MAX_ERRORS):
            look_at(house.context, shard_id)
    stack = house.again(experiment)["stack"]
    assert (stack["state"], stack["problem"]["code"], stack["n_files"]) == ("rejected", "run.internal", 6)
    assert house.seal(experiment)["stack"]["state"] == "ready"


def test_output_of_work_that_failed_is_removed(house: House) -> None:
    experiment = house.ready([Upload("film.tif", tiff(*(frame(index) for index in range(3))))])
    run = house.start(experiment)
    look_at(house.context, house.waiting("prepare")[0])
    before = house.kept_objects()
    for kept in _kept(house, experiment).iterdir():
        kept.write_bytes(b"II*\0 broken")
    house.work()
    assert house.again(run)["state"] == "failed"
    assert house.kept_objects() == before


def test_output_that_was_published_is_kept_when_only_the_answer_got_lost(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The connection may break after Postgres committed and before we hear of it."""
    experiment = house.ready()
    run = house.start(experiment)
    publish = outcomes.publish

    def publish_and_lose_the_answer(*work: Any) -> None:
        publish(*work)
        raise OperationalError("COMMIT", {}, Exception("server closed the connection"))

    with monkeypatch.context() as broken:
        for task in (prepare, detect, track, analyse):
            broken.setattr(task, "publish", publish_and_lose_the_answer)
        house.work()
    done = house.again(run)
    assert (done["state"], done["problem"]) == ("completed", None)
    assert {shard.attempts for shard in house.shards(run)} == {1}
    for file in house.ok(house.api.get(f"runs/{run['id']}/files"))["items"]:
        assert len(house.api.get(f"runs/{run['id']}/files/{file['name']}").content) == file["size_bytes"]
    assert house.ok(house.api.get(f"runs/{run['id']}/frames/1/droplets"))["x_px"]
