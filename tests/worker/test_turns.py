"""Workers are shared between people: whoever has least running comes first, then whoever waited longest."""

from collections.abc import Iterator
from uuid import UUID, uuid4

import pytest
from sqlalchemy import func, select, text, update

from backend.models import Person, Run, Shard
from backend.models.states import ShardState
from tests.house import House, Json
from worker.leases import Claim, claim
from worker.plan import Task
from worker.shards import look_at, look_in
from worker.turns import whose_turn

ANN, BEN = uuid4(), uuid4()


@pytest.fixture(autouse=True)
def _two_people(house: House) -> Iterator[None]:
    with house.context.sessions.begin() as session:
        session.add_all([Person(id=ANN, name="Ann"), Person(id=BEN, name="Ben")])
    yield
    with house.context.sessions.begin() as session:
        session.execute(text("DELETE FROM person WHERE id IN (:ann, :ben)"), {"ann": ANN, "ben": BEN})


def _run_of(house: House, person: UUID, experiment: Json) -> Json:
    """A run of somebody, prepared: six shards of detection wait."""
    run = house.start(experiment, {"detection": {"method": "paper", "radius_max_um": 20.0 + len(_runs(house))}})
    with house.context.sessions.begin() as session:
        session.execute(update(Run).where(Run.id == UUID(run["id"])).values(person_id=person))
        session.execute(update(Shard).where(Shard.run_id == UUID(run["id"])).values(person_id=person))
    (shard_id,) = [shard.id for shard in house.shards(run)]
    look_at(house.context, shard_id)
    return run


def _runs(house: House) -> list[UUID]:
    with house.context.sessions() as session:
        return list(session.scalars(select(Run.id)))


def _next(house: House, n: int) -> list[Claim]:
    """What `n` workers get that ask one after the other, none of which is done yet."""
    claims = []
    for _ in range(n):
        with house.context.sessions.begin() as session:
            taken = claim(session, whose_turn([Task.DETECT]), holder="worker", lease_s=60)
        assert taken is not None
        claims.append(taken)
    return claims


def _people_of(house: House, claims: list[Claim]) -> list[UUID | None]:
    with house.context.sessions() as session:
        return [session.get_one(Shard, taken.shard_id).person_id for taken in claims]


def test_a_person_with_many_runs_does_not_keep_another_waiting(house: House) -> None:
    experiment = house.ready()
    for _ in range(4):
        _run_of(house, ANN, experiment)
    assert _people_of(house, _next(house, 3)) == [ANN] * 3
    _run_of(house, BEN, experiment)
    assert _people_of(house, _next(house, 4)) == [BEN, BEN, BEN, ANN]


def test_with_one_worker_people_take_turns(house: House) -> None:
    experiment = house.ready()
    for person in (ANN, ANN, BEN):
        _run_of(house, person, experiment)
    served = []
    for _ in range(6):
        (taken,) = _next(house, 1)
        served += _people_of(house, [taken])
        with house.context.sessions.begin() as session:
            done = {"state": ShardState.COMPLETED, "finished_at": func.now()}
            session.execute(update(Shard).where(Shard.id == taken.shard_id).values(done))
    assert served in ([ANN, BEN] * 3, [BEN, ANN] * 3)


def test_of_one_person_the_oldest_run_comes_first_and_its_frames_in_order(house: House) -> None:
    experiment = house.ready()
    first, second = (_run_of(house, ANN, experiment) for _ in range(2))
    claims = _next(house, 7)
    assert [str(taken.run_id) for taken in claims] == [first["id"]] * 6 + [second["id"]]
    assert [taken.start_frame for taken in claims] == [0, 1, 2, 3, 4, 5, 0]


def test_a_message_has_the_next_shard_done_and_one_too_many_does_nothing(house: House) -> None:
    run = _run_of(house, ANN, house.ready())
    for queue in ["shards"] * 6 + ["sequential", "shards"] + ["shards", "sequential", "interactive", "ingest"]:
        look_in(house.context, queue)
    assert house.again(run)["state"] == "completed"
    assert all(shard.attempts == 1 for shard in house.shards(run))


def test_what_is_being_cancelled_has_no_turn(house: House) -> None:
    run = _run_of(house, ANN, house.ready())
    _next(house, 1)
    house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)
    with house.context.sessions.begin() as session:
        assert claim(session, whose_turn([Task.DETECT]), holder="worker", lease_s=60) is None
