"""Tracking of a long film gives way to somebody else's, and goes on to the very same results."""

from datetime import timedelta
from uuid import UUID

import pytest
from sqlalchemy import func, update

from backend.models import Person, Run, Shard
from backend.models.states import ShardState
from tests.films import film
from tests.house import House, Json
from worker import giving_way
from worker.shards import look_at, look_in

N_FRAMES = 70


def _until_tracking(house: House, run: Json) -> UUID:
    while not (tracks := [shard for shard in house.shards(run) if shard.task == "track"]):
        waiting = (shard for shard in house.shards(run) if shard.state == ShardState.QUEUED)
        look_at(house.context, next(waiting).id)
    return tracks[0].id


def _change(house: House, run: Json, **values: object) -> None:
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).where(Shard.run_id == UUID(run["id"])).values(values))


def _somebody_else(house: House) -> UUID:
    with house.context.sessions.begin() as session:
        person = Person(name="Somebody else")
        session.add(person)
        session.flush()
        return person.id


def _bytes(house: House, run: Json) -> list[bytes]:
    names = ("trajectories.parquet", "rejected_trajectories.parquet", "events.parquet", "flow.zarr.zip")
    return [house.api.get(f"runs/{run['id']}/files/{name}").content for name in names]


def test_tracking_gives_way_at_a_checkpoint_and_goes_on_to_the_same_bytes(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    films = [house.ready(film(n_frames)) for n_frames in (N_FRAMES, N_FRAMES, 4)]  # which does all work that waits
    mine, other, theirs = (house.start(experiment) for experiment in films)
    my_track, track, their_track = (_until_tracking(house, run) for run in (mine, other, theirs))
    monkeypatch.setattr(giving_way, "TURN_S", 0.0)
    _change(house, theirs, created_at=func.now() - timedelta(minutes=1))
    look_at(house.context, my_track)  # nobody else waits yet: all of these are of one person
    assert _shard(house, mine, my_track).state == ShardState.COMPLETED
    _change(house, theirs, person_id=(somebody := _somebody_else(house)))
    with house.context.sessions.begin() as session:
        session.execute(update(Run).where(Run.id == UUID(theirs["id"])).values(person_id=somebody))
    look_at(house.context, track)
    waiting = _shard(house, other, track)
    assert (waiting.state, waiting.attempts, waiting.kept_on) == (ShardState.QUEUED, 0, house.context.machine)
    assert list(house.context.settings.work_dir.glob(f"{track}-*/tracking/checkpoint.npz"))
    monkeypatch.setattr(giving_way, "TURN_S", 3600.0)  # else, where computing is slow, the other one gives way back
    look_in(house.context, "sequential")
    assert _shard(house, theirs, their_track).state == ShardState.COMPLETED
    look_in(house.context, "sequential")
    house.work()
    assert house.again(other)["state"] == "completed"
    assert house.again(mine)["state"] == "completed"
    assert _bytes(house, other) == _bytes(house, mine)


def test_another_machine_leaves_it_to_the_one_that_has_its_state_for_a_while(house: House) -> None:
    run = house.start(house.ready(film(4)))
    track = _until_tracking(house, run)
    _keep(house, track, minutes=10)
    look_in(house.context, "sequential")
    assert _shard(house, run, track).state == ShardState.QUEUED
    _keep(house, track, minutes=-1)
    look_in(house.context, "sequential")
    assert _shard(house, run, track).state == ShardState.COMPLETED


def _keep(house: House, shard_id: UUID, *, minutes: float) -> None:
    until = func.now() + timedelta(minutes=minutes)
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).where(Shard.id == shard_id).values(kept_on="elsewhere", kept_until=until))


def _shard(house: House, run: Json, shard_id: UUID) -> Shard:
    return next(shard for shard in house.shards(run) if shard.id == shard_id)
