"""Tracking killed at random moments between and inside its checkpoints goes on, to the same bytes."""

import random
import time
from pathlib import Path

import pytest

from backend.models import Shard
from tests.faults import Customer, Deployment, InThread, run_id
from tests.house import Json

N_FRAMES, SHAPE = 260, (120, 160)
N_KILLS, N_KILLS_A_RUN = 20, 5
_LONGEST_PAUSE_S = 0.6


def _checkpoint(place: Deployment) -> tuple[Path, int] | None:
    """The newest state that tracking has saved, and when."""
    found = [(path.stat().st_mtime_ns, path) for path in place.folder.work.glob("*/tracking/checkpoint.npz")]
    return (max(found)[1], max(found)[0]) if found else None


def _await_next_checkpoint(place: Deployment, before_ns: int, work: InThread) -> int | None:
    """When the next state was saved; None if the run ended before."""
    deadline = time.monotonic() + 120
    while work.is_alive():
        place.supervisor.check()
        try:
            found = _checkpoint(place)
        except FileNotFoundError:  # it was moved to the folder of another claim in this moment
            found = None
        if found is not None and found[1] > before_ns:
            return found[1]
        assert time.monotonic() < deadline, "tracking saves nothing"
        time.sleep(0.005)
    return None


def _disturbed(place: Deployment, customer: Customer, dice: random.Random) -> Json:
    """One film whose tracking is killed again and again, each time some way after it has saved its state."""
    runs: list[Json] = []
    work = InThread(lambda: runs.append(customer.analyse()))
    saved_ns = 0
    for _ in range(N_KILLS_A_RUN):
        found_ns = _await_next_checkpoint(place, saved_ns, work)
        if found_ns is None:
            break
        saved_ns = found_ns
        until = time.monotonic() + dice.uniform(0, _LONGEST_PAUSE_S)
        place.look_after(lambda until=until: time.monotonic() >= until, 30)  # type: ignore[misc]
        place.kill("busy track")
    place.look_after(lambda: not work.is_alive(), 300)
    if work.error is not None:
        raise work.error
    return runs[0]


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_tracking_killed_twenty_times_ends_with_the_same_bytes(place: Deployment) -> None:
    dice = random.Random()
    with place.client() as api:
        customer = Customer(api, n_frames=N_FRAMES, shape=SHAPE, patience_s=60)
        reference: list[Json] = []
        alone = InThread(lambda: reference.append(customer.analyse()))
        place.look_after(lambda: not alone.is_alive(), 300)
        expected = customer.digest(reference[0])
        n_before, n_tries = place.kills["busy track"], 0
        while place.kills["busy track"] - n_before < N_KILLS:
            run = _disturbed(place, customer, dice)
            assert run["state"] == "completed", run["problem"]
            assert customer.digest(run) == expected
            (track,) = place.shards(Shard.run_id == run_id(run), Shard.task == "track")
            n_tries += track.fence > 1
        assert n_tries
    assert place.open_work() == (0, 0)
