"""Whatever is killed, and whenever: every run ends completed, with the very results of a run that nobody disturbed."""

import random
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from backend.models import Shard
from backend.models.states import ShardState
from tests.faults import Customer, Deployment, InThread, run_id
from tests.house import Json

VICTIMS = (
    "API",
    "PostgreSQL",
    "Valkey",
    "reconciler",
    "worker shards",
    "worker sequential",
    "busy detect",
    "busy track",
)
"""What is killed: a part, or the process that works on a shard of a task."""
_LONGEST_WAIT_S = 10.0


@dataclass(frozen=True)
class Size:
    """How much is killed, of what."""

    n_kills: int
    n_frames: int
    n_customers: int
    mean_pause_s: float
    longest_s: float
    patience_s: float
    """How long a person asks again while the API is being started again and again."""


SHORT = Size(n_kills=8, n_frames=24, n_customers=1, mean_pause_s=0.8, longest_s=120, patience_s=60)
FULL = Size(n_kills=100, n_frames=48, n_customers=3, mean_pause_s=1.5, longest_s=1500, patience_s=600)


def _disturb(place: Deployment, size: Size, seed: int) -> list[Json]:
    """Kill at random moments while people have films analysed, until there were enough kills; return all runs."""
    dice = random.Random(seed)
    victims = _victims(dice)
    runs: list[Json] = []
    is_enough = False

    def work() -> None:
        with place.client() as api:
            customer = _customer(api, size)
            while not is_enough:
                runs.append(customer.analyse())

    customers = [InThread(work) for _ in range(size.n_customers)]
    n_before, deadline = place.kills.total(), time.monotonic() + size.longest_s
    while place.kills.total() - n_before < size.n_kills:
        assert time.monotonic() < deadline, f"only {dict(place.kills)} could be killed"
        pause_s = dice.expovariate(1 / size.mean_pause_s)
        until = time.monotonic() + pause_s
        place.look_after(lambda until=until: time.monotonic() >= until, pause_s + 60)  # type: ignore[misc]
        _kill_one(place, victims)
    is_enough = True
    place.look_after(lambda: not any(customer.is_alive() for customer in customers), size.longest_s)
    for customer in customers:
        if customer.error is not None:
            raise customer.error
    return runs


def _victims(dice: random.Random) -> Iterator[str]:
    """All in random order, again and again."""
    while True:
        yield from dice.sample(VICTIMS, len(VICTIMS))


def _kill_one(place: Deployment, victims: Iterator[str]) -> None:
    """Kill the next victim as soon as there is one, or the one after if nobody does that work for a while."""
    victim, until = next(victims), time.monotonic() + _LONGEST_WAIT_S
    while not place.kill(victim):
        place.supervisor.check()
        if time.monotonic() > until:
            victim, until = next(victims), time.monotonic() + _LONGEST_WAIT_S
        time.sleep(0.01)


def _customer(api: httpx.Client, size: Size) -> Customer:
    return Customer(api, n_frames=size.n_frames, shape=(240, 320), patience_s=size.patience_s)


def _assert_nothing_is_doubled_or_left(place: Deployment, runs: list[Json], n_frames: int) -> None:
    for run in runs:
        shards = place.shards(Shard.run_id == run_id(run))
        assert {shard.state for shard in shards} == {ShardState.COMPLETED}
        detected = [frame for shard in shards if shard.task == "detect" for frame in _frames(shard)]
        assert detected == list(range(n_frames))
        assert sorted(shard.task for shard in shards if shard.task != "detect") == ["analyse", "prepare", "track"]
        assert [stage["done_frames"] for stage in run["stages"]] == [n_frames] * 3
    assert place.open_work() == (0, 0)
    assert place.shards(Shard.state.in_([ShardState.FAILED, ShardState.CANCELLED])) == []
    work = [path for path in place.folder.work.iterdir() if path.name != "alive"]
    signs = list((place.folder.work / "alive").iterdir()) if (place.folder.work / "alive").exists() else []
    place.look_after(lambda: not [path for path in work if path.exists()], 30)
    place.look_after(lambda: not [sign for sign in signs if _is_of_a_living_process(sign)], 30)


def _is_of_a_living_process(sign: Path) -> bool:
    return sign.exists() and Path(f"/proc/{sign.name.rpartition('-')[2]}").exists()


def _frames(shard: Shard) -> range:
    return range(shard.start_frame, shard.stop_frame)


def _prove(place: Deployment, size: Size, seed: int) -> None:
    with place.client() as api:
        customer = _customer(api, size)
        reference: list[Json] = []
        alone = InThread(lambda: reference.append(customer.analyse()))
        place.look_after(lambda: not alone.is_alive(), size.longest_s)
        assert alone.error is None, alone.error
        assert reference[0]["state"] == "completed", reference[0]["problem"]
        expected = customer.digest(reference[0])
        began_s = time.monotonic()
        runs = _disturb(place, size, seed)
        print(  # noqa: T201 - the figures of the proof
            f"\nseed {seed}: {place.kills.total()} kills in {time.monotonic() - began_s:.0f} s over {len(runs)} runs: "
            + ", ".join(f"{victim} {n}" for victim, n in sorted(place.kills.items()))
        )
        place.look_after(lambda: place.process_of("API") is not None, 30)
        for run in runs:
            assert run["state"] == "completed", run["problem"]
            assert customer.digest(run) == expected
        _assert_nothing_is_doubled_or_left(place, [*reference, *runs], size.n_frames)


def test_eight_kills_change_nothing(place: Deployment) -> None:
    _prove(place, SHORT, random.randrange(10**6))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_hundred_kills_change_nothing(place: Deployment) -> None:
    _prove(place, FULL, random.randrange(10**6))
