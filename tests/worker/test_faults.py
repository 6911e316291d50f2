"""What can happen beside a kill: messages lost and doubled, a process that hangs, a database that goes, a full disk."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import func, select

from backend.models import Shard
from backend.models.states import ShardState
from backend.platform.settings import Settings
from tests.faults import Customer, Deployment, InThread
from tests.house import House, Json, open_house
from worker.leases import claim
from worker.shards import look_at

N_FRAMES, SHAPE = 24, (240, 320)


@contextmanager
def _customer(place: Deployment) -> Iterator[Customer]:
    with place.client() as api:
        yield Customer(api, n_frames=N_FRAMES, shape=SHAPE, patience_s=60)


def _begin(customer: Customer) -> tuple[InThread, list[Json]]:
    """One film, from the upload to the end, beside the test."""
    runs: list[Json] = []
    return InThread(lambda: runs.append(customer.analyse())), runs


def _completed(place: Deployment, work: InThread, runs: list[Json]) -> Json:
    place.look_after(lambda: not work.is_alive(), 200)
    assert work.error is None, work.error
    assert runs[0]["state"] == "completed", runs[0]["problem"]
    assert place.open_work() == (0, 0)
    return runs[0]


def _await_task(place: Deployment, task: str) -> Shard:
    """Whoever works on a shard of this task, as soon as there is somebody."""
    found: list[Shard] = []

    def is_at_work() -> bool:
        found[:] = place.shards(Shard.state == ShardState.RUNNING, Shard.task == task)
        return bool(found)

    place.look_after(is_at_work, 60)
    return found[0]


@pytest.mark.slow
def test_messages_that_are_lost_or_come_twice_change_nothing(place: Deployment) -> None:
    with _customer(place) as customer:
        expected = customer.digest(_completed(place, *_begin(customer)))
        work, runs = _begin(customer)
        n_doubled, rounds = 0, 0
        while work.is_alive():
            n_doubled += place.double_messages()
            rounds += 1
            if rounds % 20 == 0:
                place.forget_messages()
            until = time.monotonic() + 0.02
            place.look_after(lambda until=until: time.monotonic() > until, 5)  # type: ignore[misc]
        assert customer.digest(_completed(place, work, runs)) == expected
        assert n_doubled > 0
    assert {shard.attempts for shard in place.shards()} == {1}


@pytest.mark.slow
def test_a_process_that_hangs_is_replaced_and_its_work_done_by_another(place: Deployment) -> None:
    with _customer(place) as customer:
        work, runs = _begin(customer)
        hung = int(str(_await_task(place, "detect").holder).rpartition(":")[2])
        os.kill(hung, signal.SIGSTOP)
        run = _completed(place, work, runs)
        place.look_after(lambda: not Path(f"/proc/{hung}").exists(), 60)
        assert [stage["done_frames"] for stage in run["stages"]] == [N_FRAMES] * 3


@pytest.mark.slow
def test_a_database_that_is_restarted_in_mid_run_costs_nothing_but_time(place: Deployment) -> None:
    with _customer(place) as customer:
        expected = customer.digest(_completed(place, *_begin(customer)))
        work, runs = _begin(customer)
        for task in ("detect", "track"):
            _await_task(place, task)
            process = place.process_of("PostgreSQL")
            assert process is not None
            os.kill(process, signal.SIGINT)  # as an administrator stops it: at once, everybody is disconnected
            place.look_after(lambda old=process: place.process_of("PostgreSQL") not in (None, old), 60)  # type: ignore[misc]
        assert customer.digest(_completed(place, work, runs)) == expected


@pytest.mark.parametrize("jump_s", [-86400.0, 86400.0])
def test_a_worker_whose_clock_jumps_holds_its_lease_as_long_as_any_other(
    house: House, monkeypatch: pytest.MonkeyPatch, jump_s: float
) -> None:
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    true_time = time.time
    with monkeypatch.context() as wrong:
        wrong.setattr(time, "time", lambda: true_time() + jump_s)
        with house.context.sessions.begin() as session:
            taken = claim(session, house.waiting("detect")[0], holder="elsewhere", lease_s=60)
            assert taken is not None
        with house.context.sessions.begin() as session:
            left = select(func.extract("epoch", Shard.lease_until - func.clock_timestamp()))
            assert 50 < float(session.scalars(left.where(Shard.id == taken.shard_id)).one()) <= 60
            assert claim(session, taken.shard_id, holder="other", lease_s=60) is None
        house.work()
    with house.context.sessions.begin() as session:
        session.get_one(Shard, taken.shard_id).state = ShardState.QUEUED
    house.work()
    assert house.again(run)["state"] == "completed"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of a few megabytes."""
    folder = tmp_path / "small"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", folder], capture_output=True)
    if mounted.returncode != 0:
        pytest.skip("a file system of its own can be mounted by root alone")
    yield folder
    subprocess.run(["umount", "--lazy", folder], check=True)


@contextmanager
def _filled(folder: Path) -> Iterator[None]:
    filler = folder / "filler"
    with filler.open("wb", buffering=0) as file:
        try:
            while True:
                file.write(b"\0" * 65536)
        except OSError:
            pass
    yield
    filler.unlink()


@pytest.mark.parametrize(("full", "task"), [("objects", "detect"), ("work", "track")])
def test_a_disk_that_fills_up_in_mid_run_fails_it_with_the_cause_and_a_retry_goes_on(
    settings: Settings, small_disk: Path, full: str, task: str
) -> None:
    elsewhere = (
        {"object_store_url": (small_disk / "objects").as_uri()}
        if full == "objects"
        else {"work_dir": small_disk / "work"}
    )
    with open_house(settings.model_copy(update=elsewhere)) as house:
        run = house.start(house.ready())
        while not house.waiting(task):
            look_at(house.context, house.waiting()[0])
        with _filled(small_disk):
            house.work()
        failed = house.again(run)
        assert (failed["state"], failed["problem"]["code"]) == ("failed", "run.no_space")
        assert str(small_disk) not in str(failed)
        again = house.ok(house.api.post(f"runs/{run['id']}/retry"), 202)
        house.work()
        done = house.again(again)
        assert done["state"] == "completed", done["problem"]
        assert done["stages"][0]["reused_frames"] == (6 if task == "track" else 0)
