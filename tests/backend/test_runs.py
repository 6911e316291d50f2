"""Runs: how they begin, go on, are stopped, tried again and removed."""

from pathlib import Path

import pytest
from sqlalchemy import select, update

from backend.models import Product, Run, Shard
from backend.models.states import ShardState
from backend.results.catalogue import LATER, NEVER
from tests.films import PARAMETERS
from tests.house import House, Json
from worker.shards import look_at

TRACKING_ONLY = {"flow": {"n_columns": 6, "n_rows": 5}}


def _states(run: Json) -> list[str]:
    return [stage["state"] for stage in run["stages"]]


def _objects_of(house: House, experiment: Json) -> set[str]:
    return {key for key in house.kept_objects() if experiment["id"] in key and "/products/" in key}


def test_a_new_run_waits_with_all_its_parameters_and_stages(house: House) -> None:
    ready = house.ready()
    run = house.start(ready, {})
    assert run["state"] == "queued"
    assert run["number"] == 1
    assert run["parameters"]["detection"]["radius_min_um"] == 4.0
    assert [(stage["name"], stage["total_frames"]) for stage in run["stages"]] == [
        ("detect", 6),
        ("track", 6),
        ("analyse", 6),
    ]
    assert _states(run) == ["waiting"] * 3
    assert house.start(ready)["number"] == 2


@pytest.mark.parametrize(
    ("parameters", "code", "field"),
    [
        ({"detection": {"radius_min_um": 30, "radius_max_um": 20}}, "parameters.invalid", "detection.radius_min_um"),
        ({"detection": {"radius_max_um": 5000}}, "parameters.radius_range", "detection.radius_max_um"),
        (
            {"detection": {"radius_min_um": 0.5, "radius_max_um": 5}},
            "parameters.radius_range",
            "detection.radius_min_um",
        ),
        ({"detection": {"surprise": 1}}, "parameters.invalid", "detection.surprise"),
        ({"flow": {"n_columns": 1}}, "parameters.invalid", "flow.n_columns"),
        ({"a\0b": 1}, "parameters.invalid", "(name of a field)"),
    ],
)
def test_parameters_that_do_not_fit_are_refused_naming_the_field(
    shared_house: House, ready: Json, parameters: Json, code: str, field: str
) -> None:
    answer = shared_house.api.post(f"experiments/{ready['id']}/runs", json={"parameters": parameters})
    assert answer.status_code == 422
    assert answer.json()["code"] == code
    assert field in [found["field"] for found in answer.json()["errors"]]
    assert shared_house.again(ready)["n_runs"] == 0


@pytest.fixture(scope="module")
def ready(shared_house: House) -> Json:
    return shared_house.ready()


def test_a_run_needs_frames(house: House) -> None:
    answer = house.api.post(f"experiments/{house.experiment()['id']}/runs", json={"parameters": {}})
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.stack_not_ready"


def test_runs_are_listed_newest_first_page_by_page(house: House) -> None:
    ready = house.ready()
    for _ in range(3):
        house.start(ready)
    first = house.ok(house.api.get(f"experiments/{ready['id']}/runs", params={"limit": 2}))
    rest = house.ok(
        house.api.get(f"experiments/{ready['id']}/runs", params={"limit": 2, "cursor": first["next_cursor"]})
    )
    assert [run["number"] for run in first["items"] + rest["items"]] == [3, 2, 1]
    assert rest["next_cursor"] is None


def test_a_run_completes_with_a_summary_and_says_when(house: House) -> None:
    run = house.start(house.ready())
    house.work()
    done = house.again(run)
    assert done["state"] == "completed"
    assert _states(done) == ["completed"] * 3
    assert [stage["done_frames"] for stage in done["stages"]] == [6, 6, 6]
    assert done["summary"]["detected"]["n_droplets"] >= 5 * 6
    assert done["created_at"] <= done["started_at"] <= done["finished_at"]
    assert done["problem"] is None


def test_half_way_the_stages_say_how_far_they_are_and_how_long_it_takes(house: House) -> None:
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    for shard_id in house.waiting("detect")[:3]:
        look_at(house.context, shard_id)
    now = house.again(run)
    assert (now["state"], _states(now)) == ("running", ["running", "waiting", "waiting"])
    detect = now["stages"][0]
    assert detect["done_frames"] == 3
    assert detect["frames_per_s"] > 0
    assert detect["seconds_left"] == pytest.approx(3 / detect["frames_per_s"], rel=0.05, abs=0.1)
    assert detect["seconds_left_std"] >= 0


def test_a_run_that_waits_is_cancelled_at_once_and_never_begins(house: House) -> None:
    run = house.start(house.ready())
    cancelled = house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)
    assert (cancelled["state"], _states(cancelled)) == ("cancelled", ["cancelled"] * 3)
    house.work()
    assert house.again(run)["state"] == "cancelled"
    figures = house.ok(house.api.get(f"runs/{run['id']}/figures"))["items"]
    reasons = {entry["reason"] for entry in figures if not entry["is_available"]}
    assert NEVER in reasons
    assert not reasons & set(LATER.values())
    assert house.waiting() == []


def test_what_a_worker_holds_is_cancelled_when_it_lets_go(house: House) -> None:
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    with house.context.sessions.begin() as session:
        session.execute(
            update(Shard).where(Shard.id == house.waiting("detect")[0]).values(state=ShardState.RUNNING, fence=1)
        )
    asked = house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)
    assert (asked["state"], asked["is_cancelling"]) == ("running", True)
    assert house.waiting() == []


def test_what_has_ended_is_not_cancelled(house: House) -> None:
    run = house.start(house.ready())
    house.work()
    answer = house.api.post(f"runs/{run['id']}/cancel")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.run_finished"
    assert house.again(run)["state"] == "completed"


def test_only_what_failed_is_retried(house: House) -> None:
    run = house.start(house.ready())
    house.work()
    answer = house.api.post(f"runs/{run['id']}/retry")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.run_not_failed"


def test_a_retry_is_a_new_run_that_does_not_do_again_what_was_done(house: House) -> None:
    experiment = house.ready()
    run = house.start(experiment)
    look_at(house.context, house.waiting("prepare")[0])
    detect = house.waiting("detect")
    for shard_id in detect[:4]:
        look_at(house.context, shard_id)
    broken = _break_a_frame(house, experiment, 5)
    house.work()
    failed = house.again(run)
    assert failed["state"] == "failed"
    assert failed["problem"]["code"] == "frames.truncated"
    assert (failed["problem"]["file"], failed["problem"]["frame"]) == ("frames/frame5.tif", 5)
    assert _states(failed) == ["failed", "cancelled", "cancelled"]

    broken.write_bytes(broken.with_suffix(".whole").read_bytes())
    again = house.ok(house.api.post(f"runs/{run['id']}/retry"), 202)
    assert (again["number"], again["parameters"]) == (2, run["parameters"])
    house.work()
    done = house.again(again)
    assert done["state"] == "completed"
    assert done["stages"][0]["reused_frames"] == 5
    assert house.again(run) == failed


def _break_a_frame(house: House, experiment: Json, index: int) -> Path:
    files = house.ok(house.api.get(f"experiments/{experiment['id']}/files"))["items"]
    (file_id,) = [file["id"] for file in files if file["name"].endswith(f"{index}.tif")]
    kept = house.objects / "experiments" / experiment["id"] / "files" / file_id
    kept.with_suffix(".whole").write_bytes(kept.read_bytes())
    kept.write_bytes(kept.read_bytes()[:1000])
    return kept


def test_a_run_that_changes_only_tracking_takes_over_the_detections(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    second = house.start(ready, PARAMETERS | TRACKING_ONLY)
    house.work()
    done = house.again(second)
    assert done["state"] == "completed"
    assert [stage["reused_frames"] for stage in done["stages"]] == [6, 0, 0]
    assert done["summary"]["detected"] == house.again(first)["summary"]["detected"]


def test_the_same_run_again_takes_over_everything(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    kept = _objects_of(house, ready)
    second = house.start(ready)
    house.work()
    done = house.again(second)
    assert [stage["reused_frames"] for stage in done["stages"]] == [6, 6, 6]
    assert done["summary"] == house.again(first)["summary"]
    assert len(_objects_of(house, ready) - kept) == 2  # its own index and estimate
    detected = house.ok(house.api.get(f"runs/{second['id']}/frames/3/droplets"))
    assert detected == house.ok(house.api.get(f"runs/{first['id']}/frames/3/droplets"))


def test_other_detection_takes_over_nothing(house: House) -> None:
    ready = house.ready()
    house.start(ready)
    house.work()
    other = house.start(ready, PARAMETERS | {"detection": PARAMETERS["detection"] | {"radius_max_um": 19.0}})
    house.work()
    assert [stage["reused_frames"] for stage in house.again(other)["stages"]] == [0, 0, 0]


def test_a_new_name_for_the_experiment_keeps_the_detections(house: House) -> None:
    ready = house.ready()
    house.start(ready)
    house.work()
    house.ok(
        house.api.patch(f"experiments/{ready['id']}", json={"experiment": ready["experiment"] | {"name": "renamed"}})
    )
    second = house.start(ready)
    house.work()
    assert house.again(second)["stages"][0]["reused_frames"] == 6


def test_a_corrected_pixel_size_is_used_and_nothing_stale(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    house.ok(
        house.api.patch(f"experiments/{ready['id']}", json={"experiment": ready["experiment"] | {"pixel_size_um": 0.9}})
    )
    second = house.start(ready)
    house.work()
    done = house.again(second)
    assert done["stages"][0]["reused_frames"] == 0
    assert done["summary"]["field_of_view_um"] != house.again(first)["summary"]["field_of_view_um"]


def test_a_deleted_run_takes_its_objects_with_it_but_not_those_that_others_share(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    second = house.start(ready, PARAMETERS | TRACKING_ONLY)
    house.work()
    assert house.api.delete(f"runs/{first['id']}", params={"forever": True}).status_code == 204
    assert house.api.get(f"runs/{first['id']}").status_code == 404
    assert len(house.ok(house.api.get(f"runs/{second['id']}/frames/2/droplets"))["x_px"]) >= 5
    kept = _objects_of(house, ready)
    with house.context.sessions() as session:
        prefixes = set(session.scalars(select(Product.prefix)))
    of_stack = {key for key in kept if _is_of_stack(house, key)}
    assert {key.rsplit("/", 1)[0].split("/flow.zarr")[0] + "/" for key in kept - of_stack} == prefixes
    assert house.api.delete(f"runs/{second['id']}", params={"forever": True}).status_code == 204
    assert _objects_of(house, ready) == of_stack
    assert house.again(ready)["stack"]["state"] == "ready"


def _is_of_stack(house: House, key: str) -> bool:
    """Whether a key is the index of the stack, which belongs to no run."""
    with house.context.sessions() as session:
        ingest = session.scalars(select(Shard.id).where(Shard.task == "ingest"))
        return any(str(shard_id) in key for shard_id in ingest)


def test_a_run_is_not_deleted_while_it_goes_on(house: House) -> None:
    run = house.start(house.ready())
    answer = house.api.delete(f"runs/{run['id']}")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.run_active"


def _reuse(house: House, run: Json) -> Json:
    return house.ok(house.api.get(f"runs/{run['id']}/reuse"))


def test_what_was_taken_over_and_why_not_the_rest_is_said(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    assert _reuse(house, first)["compared_with"] is None
    second = house.start(ready, PARAMETERS | TRACKING_ONLY)
    house.work()
    said = _reuse(house, second)
    assert said["compared_with"] == 1
    detect, track, _ = said["stages"]
    assert (detect["reused_frames"], detect["differences"]) == (6, [])
    assert track["reused_frames"] == 0
    assert track["differences"] == [
        {"cause": "parameter", "field": "flow.n_columns", "before": 5, "now": 6},
        {"cause": "parameter", "field": "flow.n_rows", "before": 4, "now": 5},
    ]


def test_a_corrected_experiment_is_named_as_the_cause(house: House) -> None:
    ready = house.ready()
    house.start(ready)
    house.work()
    house.ok(
        house.api.patch(f"experiments/{ready['id']}", json={"experiment": ready["experiment"] | {"pixel_size_um": 0.9}})
    )
    second = house.start(ready)
    house.work()
    for stage in _reuse(house, second)["stages"]:
        assert stage["differences"] == [{"cause": "experiment", "field": "pixel_size_um", "before": 1.0, "now": 0.9}]


def test_other_code_is_named_as_the_cause(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    with house.context.sessions.begin() as session:
        session.execute(update(Run).values(source_digest="0" * 64))
        session.execute(update(Product).values(input_key="other", film_key="other"))
    second = house.start(ready)
    house.work()
    assert [found["cause"] for found in _reuse(house, second)["stages"][0]["differences"]] == ["code"]
    assert house.again(first)["state"] == "completed"


def test_a_cancelled_run_frees_its_space_but_not_what_others_share(house: House) -> None:
    ready = house.ready()
    first = house.start(ready)
    house.work()
    kept = _objects_of(house, ready)
    second = house.start(ready, PARAMETERS | TRACKING_ONLY)
    look_at(house.context, house.waiting("prepare")[0])
    assert _objects_of(house, ready) > kept
    cancelled = house.ok(house.api.post(f"runs/{second['id']}/cancel"), 202)
    assert cancelled["state"] == "cancelled"
    assert _objects_of(house, ready) == kept
    assert len(house.ok(house.api.get(f"runs/{first['id']}/frames/2/droplets"))["x_px"]) >= 5


def test_what_was_half_written_by_those_who_were_killed_is_removed(house: House) -> None:
    run = house.start(house.ready())
    (shard_id,) = house.waiting("prepare")
    prefix = f"experiments/{run['experiment_id']}/products/{shard_id}/1/"
    house.context.store.put(prefix + "half", b"written before the kill")
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).where(Shard.id == shard_id).values(fence=1))
    house.work()
    assert house.again(run)["state"] == "completed"
    assert not [key for key in house.kept_objects() if key.startswith(prefix)]
