"""Leases: one holder at a time, and whoever lost a lease can change nothing any more."""

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from uuid import UUID

import pytest
from sqlalchemy import func, make_url, select, update

from backend.models import Product, Run, Shard
from backend.models.states import ShardState
from backend.platform.database import Sessions, make_engine, make_sessions
from dropflow.errors import Cancelled
from tests.house import House, Json
from worker import leases, outcomes
from worker.context import Context
from worker.leases import MAX_ATTEMPTS, Claim, Lease, LeaseLost, claim
from worker.outcomes import NewProduct
from worker.shards import look_at


@pytest.fixture
def run(house: House) -> Json:
    """A run whose six shards of detection wait."""
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    return run


def _claim(house: House, shard_id: UUID, holder: str = "me", lease_s: float = 60) -> Claim | None:
    with house.context.sessions.begin() as session:
        return claim(session, shard_id, holder=holder, lease_s=lease_s)


def _take(house: House, lease_s: float = 60) -> Lease:
    taken = _claim(house, house.waiting("detect")[0], lease_s=lease_s)
    assert taken is not None
    return Lease(house.context.sessions, taken, lease_s=lease_s)


def _let_expire(house: House, shard_id: UUID) -> None:
    past = func.clock_timestamp() - timedelta(seconds=1)
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).where(Shard.id == shard_id).values(lease_until=past))


def _shard(house: House, shard_id: UUID) -> Shard:
    with house.context.sessions() as session:
        return session.get_one(Shard, shard_id)


def test_of_many_who_claim_at_once_one_gets_the_shard(house: House, run: Json) -> None:
    (shard_id, *_) = house.waiting("detect")
    start = threading.Barrier(8)

    def reach(number: int) -> Claim | None:
        start.wait()
        with house.context.sessions.begin() as session:
            return claim(session, shard_id, holder=f"worker {number}", lease_s=60)

    # Two connections in the pool: the others wait for one, and come just after.
    with ThreadPoolExecutor(8) as pool:
        claims = [taken for taken in pool.map(reach, range(8)) if taken is not None]
    assert len(claims) == 1
    kept = _shard(house, shard_id)
    assert (kept.state, kept.fence, kept.attempts) == (ShardState.RUNNING, 1, 1)


def test_a_held_shard_is_not_claimed_and_an_expired_one_is_with_a_new_fence(house: House, run: Json) -> None:
    lease = _take(house)
    shard_id = lease.claim.shard_id
    assert _claim(house, shard_id) is None
    _let_expire(house, shard_id)
    second = _claim(house, shard_id, "other")
    assert second is not None
    assert second.fence == lease.claim.fence + 1
    with pytest.raises(LeaseLost):
        lease.renew()


def test_a_lease_runs_out_by_the_clock_of_the_database(house: House, run: Json) -> None:
    shard_id = house.waiting("detect")[0]
    assert _claim(house, shard_id, lease_s=1) is not None
    assert _claim(house, shard_id) is None
    time.sleep(1.1)
    assert _claim(house, shard_id) is not None


def test_whoever_lost_the_lease_publishes_nothing(house: House, run: Json) -> None:
    lease = _take(house)
    _let_expire(house, lease.claim.shard_id)
    assert _claim(house, lease.claim.shard_id, "other") is not None
    for late in (
        lambda: outcomes.publish(house.context, lease.claim, NewProduct("late/")),
        lambda: outcomes.let_go(house.context, lease.claim),
    ):
        with pytest.raises(LeaseLost):
            late()
    outcomes.give_back(house.context, lease.claim)
    kept = _shard(house, lease.claim.shard_id)
    assert (kept.state, kept.holder, kept.product_id) == (ShardState.RUNNING, "other", None)
    with house.context.sessions() as session:
        assert session.scalar(select(func.count()).select_from(Product).where(Product.prefix == "late/")) == 0


def test_a_shard_is_published_once_however_often_it_is_tried(house: House, run: Json) -> None:
    lease = _take(house)
    outcomes.publish(house.context, lease.claim, NewProduct("first/"))
    with pytest.raises(LeaseLost):
        outcomes.publish(house.context, lease.claim, NewProduct("second/"))
    with house.context.sessions() as session:
        assert session.scalar(select(func.count()).select_from(Product).where(Product.task == "detect")) == 1


def test_progress_renews_the_lease_and_is_seen(house: House, run: Json) -> None:
    lease = _take(house)
    before = _shard(house, lease.claim.shard_id)
    lease("detect", 1, 1)
    after = _shard(house, lease.claim.shard_id)
    assert after.done_frames == 1
    assert before.lease_until is not None
    assert after.lease_until is not None
    assert after.lease_until > before.lease_until


def test_where_to_say_how_far_it_is_takes_long_it_is_said_less_often(
    house: House, run: Json, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(leases, "_SHORTEST_RENEWAL_S", 0.05)
    lease = _take(house, lease_s=4)
    shard_id = lease.claim.shard_id
    with ThreadPoolExecutor(1) as pool:
        with house.context.sessions.begin() as session:
            session.execute(select(Shard.id).where(Shard.id == shard_id).with_for_update())
            renewal = pool.submit(lease.renew)
            time.sleep(0.3)
        renewal.result()
    before = _shard(house, shard_id).lease_until
    time.sleep(0.1)
    lease("detect", 1, 3)
    assert _shard(house, shard_id).lease_until == before
    time.sleep(1.0)
    lease("detect", 2, 3)
    assert _shard(house, shard_id).lease_until != before, "but in time for the lease"


def test_progress_that_is_not_in_frames_of_the_shard_is_scaled_to_them(house: House, run: Json) -> None:
    house.work()
    with house.context.sessions.begin() as session:
        track = select(Shard.id).where(Shard.task == "track", Shard.run_id == UUID(run["id"]))
        shard_id = session.scalars(track).one()
        session.execute(update(Shard).where(Shard.id == shard_id).values(state=ShardState.QUEUED, attempts=0))
        session.execute(update(Run).values(state="running"))
    taken = _claim(house, shard_id)
    assert taken is not None
    lease = Lease(house.context.sessions, taken, lease_s=60)
    lease.renew()
    lease("track", 24, 24)
    assert _shard(house, shard_id).done_frames == 6


def test_the_renewal_tells_of_a_cancel(house: House, run: Json) -> None:
    lease = _take(house)
    house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)
    with pytest.raises(Cancelled):
        lease("detect", 1, 1)
    outcomes.let_go(house.context, lease.claim)
    assert house.again(run)["state"] == "cancelled"


def test_what_is_not_wanted_any_more_is_not_claimed(house: House, run: Json) -> None:
    lease = _take(house)
    house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)
    _let_expire(house, lease.claim.shard_id)
    assert _claim(house, lease.claim.shard_id) is None


def test_a_deleted_run_takes_the_lease_with_it(house: House, run: Json) -> None:
    lease = _take(house)
    with house.context.sessions.begin() as session:
        session.execute(update(Run).values(state="failed"))
    assert house.api.delete(f"runs/{run['id']}", params={"forever": True}).status_code == 204
    with pytest.raises(LeaseLost):
        lease.renew()
    with pytest.raises(LeaseLost):
        outcomes.publish(house.context, lease.claim, NewProduct("late/"))


def test_after_too_many_tries_nobody_claims(house: House, run: Json) -> None:
    shard_id = house.waiting("detect")[0]
    for attempt in range(1, MAX_ATTEMPTS + 1):
        taken = _claim(house, shard_id)
        assert taken is not None
        assert taken.attempts == attempt
        _let_expire(house, shard_id)
    assert _claim(house, shard_id) is None


@pytest.mark.parametrize("give_back", [outcomes.give_back, outcomes.give_back_after_error])
def test_what_is_given_back_uses_up_no_try(
    house: House, run: Json, give_back: Callable[[Context, Claim], None]
) -> None:
    shard_id = house.waiting("detect")[0]
    for _ in range(MAX_ATTEMPTS + 1):
        taken = _claim(house, shard_id)
        assert taken is not None, "a shard that nobody may take would wait for ever"
        give_back(house.context, taken)


def test_a_worker_that_stops_gives_back_what_it_holds_and_the_try_does_not_count(house: House, run: Json) -> None:
    lease = _take(house)
    other = _claim(house, house.waiting("detect")[0], "elsewhere:1:2")
    assert other is not None
    assert outcomes.give_back_all(house.context, "me%") == 1
    kept = _shard(house, lease.claim.shard_id)
    assert (kept.state, kept.attempts, kept.lease_until) == (ShardState.QUEUED, 0, None)
    assert _shard(house, other.shard_id).state == ShardState.RUNNING
    with pytest.raises(LeaseLost):
        lease.renew()


def test_while_postgres_is_away_a_lease_is_kept_as_long_as_nobody_else_could_have_it(
    house: House, run: Json, monkeypatch: pytest.MonkeyPatch
) -> None:
    lease = _take(house, lease_s=1)
    broken = Lease(house.context.sessions, lease.claim, lease_s=1)
    unreachable = _unreachable(house)
    monkeypatch.setattr(broken, "_sessions", unreachable)
    broken.renew()
    monkeypatch.setattr(broken, "_renewed", broken._renewed - 2)
    with pytest.raises(LeaseLost):
        broken.renew()


def _unreachable(house: House) -> Sessions:
    """Sessions on a port where nobody listens."""
    url = make_url(house.context.settings.database_url).set(port=1)
    return make_sessions(make_engine(url.render_as_string(hide_password=False), application="test"))
