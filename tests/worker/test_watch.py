"""What died gives its work back at once; what hangs loses its place."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from uuid import UUID

import pytest
from sqlalchemy import func, update

from backend.models import Shard
from backend.models.states import ShardState
from tests.house import House, Json
from worker.context import make_context
from worker.heartbeat import at_work, end_silent
from worker.leases import MAX_ATTEMPTS
from worker.reconcile import reconcile
from worker.shards import look_at
from worker.watch import give_back_of_the_dead, watch


@pytest.fixture
def run(house: House) -> Json:
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    return run


def _hold(house: House, shard_id: UUID, process: int) -> None:
    host = house.context.holder.split(":")[0]
    held = {"state": ShardState.RUNNING, "fence": 1, "holder": f"{host}:1:{process}"}
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).where(Shard.id == shard_id).values(held))


def _dead_process() -> int:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    return ended.pid


def test_what_a_dead_process_held_is_given_back_and_what_others_hold_is_not(house: House, run: Json) -> None:
    lost, ours, elsewhere = house.waiting("detect")[:3]
    _hold(house, lost, _dead_process())
    _hold(house, ours, os.getpid())
    with house.context.sessions.begin() as session:
        session.execute(
            update(Shard).where(Shard.id == elsewhere).values(state=ShardState.RUNNING, holder="elsewhere:1:2")
        )
    assert give_back_of_the_dead(house.context) == 1
    states = {shard.id: (shard.state, shard.fence) for shard in house.shards(run)}
    assert states[lost] == (ShardState.QUEUED, 2)
    assert states[ours][0] == states[elsewhere][0] == ShardState.RUNNING


def test_what_has_silenced_one_process_too_many_is_not_put_back_where_nobody_would_take_it(
    house: House, run: Json
) -> None:
    (shard_id, *_) = house.waiting("detect")
    _hold(house, shard_id, _dead_process())
    with house.context.sessions.begin() as session:
        past = {"attempts": MAX_ATTEMPTS, "lease_until": func.clock_timestamp()}
        session.execute(update(Shard).where(Shard.id == shard_id).values(past))
    assert give_back_of_the_dead(house.context) == 0
    reconcile(house.context)
    assert house.again(run)["problem"]["code"] == "run.worker_lost"


def test_a_worker_that_died_while_nobody_looked_is_found_at_the_next_look(house: House, run: Json) -> None:
    (shard_id, *_) = house.waiting("detect")
    _hold(house, shard_id, _dead_process())
    watch(house.context)
    house.work()
    assert house.again(run)["state"] == "completed"


def _sleeping_child(work_dir: Path) -> subprocess.Popen[bytes]:
    """A process that says once that it works, and nothing after."""
    program = (
        "import sys, time, pathlib\n"
        "from worker.heartbeat import at_work\n"
        "with at_work(pathlib.Path(sys.argv[1])): time.sleep(60)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", program, work_dir])
    deadline = time.monotonic() + 20
    while not list((work_dir / "alive").glob(f"*-{child.pid}")):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return child


def test_a_child_that_is_silent_for_too_long_is_killed_even_if_it_is_stopped(tmp_path: Path) -> None:
    child = _sleeping_child(tmp_path)
    child.send_signal(signal.SIGSTOP)
    assert end_silent(tmp_path, os.getpid(), 60.0) == []
    assert end_silent(tmp_path, os.getpid(), 0.0) == [child.pid]
    assert child.wait(timeout=10) == -signal.SIGKILL
    assert list((tmp_path / "alive").iterdir()) == []


def test_a_process_that_is_nobodys_child_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "alive").mkdir()
    (tmp_path / "alive" / f"{os.getpid()}-{os.getppid()}").write_text("0.0")
    assert end_silent(tmp_path, os.getpid(), 1.0) == []


def test_who_says_how_far_it_is_lives(tmp_path: Path) -> None:
    with at_work(tmp_path) as beat:
        (path,) = (tmp_path / "alive").iterdir()
        before = float(path.read_text())
        time.sleep(0.01)
        beat()
        assert float(path.read_text()) > before
    assert list((tmp_path / "alive").iterdir()) == []


def test_watching_goes_on_without_a_folder_of_signs(house: House) -> None:
    context = make_context(house.context.settings)
    watch(context)
    context.close()
