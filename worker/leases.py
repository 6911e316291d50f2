"""Leases: who works on a shard, and until when others keep away.

A claim is one UPDATE, which also raises the shard's fence; everything the holder does later names that fence, so
whoever lost the lease can no longer change anything. Time is the database's, never a worker's clock.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import timedelta
from typing import Any
from uuid import UUID

import structlog
from sqlalchemy import ColumnElement, ScalarSelect, and_, exists, func, or_, select, update
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from backend.models import Run, Shard
from backend.models.states import ACTIVE_RUN_STATES, SHARD_RULES, ShardState, rule
from backend.platform.database import Sessions
from backend.platform.events import announcing, experiment_topic, run_topic
from backend.platform.reasons import reason_of
from dropflow.errors import Cancelled
from dropflow.tracking.film import FRAMES_PER_PART
from worker.pace import Pace

MAX_ATTEMPTS = 8
"""A shard whose holders fell silent so often in a row is what silences them. Machines are rebooted and processes
killed for reasons that are no shard's, so fewer would end runs that are sound."""
MAX_ERRORS = 3
"""An error that nobody expected is not going to pass after so many."""
_SHORTEST_RENEWAL_S = 0.5
_RENEWAL_SHARE = 20
"""Where to renew takes long, for the database is busy with many workers, it is done as seldom as to take a twentieth of
the time."""
log = structlog.get_logger()


class LeaseLost(Exception):
    """Somebody else has the shard now, or nobody needs it any more. Whatever was made of it does not count."""


@dataclass(frozen=True)
class Claim:
    """A shard in our hands."""

    shard_id: UUID
    experiment_id: UUID
    run_id: UUID | None
    task: str
    start_frame: int
    stop_frame: int
    input_key: str | None
    fence: int
    attempts: int
    n_errors: int = 0

    @property
    def topics(self) -> tuple[str, ...]:
        """Who wants to hear of it."""
        return (run_topic(self.run_id),) if self.run_id else (experiment_topic(self.experiment_id),)


def claim(session: Session, which: UUID | ScalarSelect[UUID], *, holder: str, lease_s: float) -> Claim | None:
    """Take a shard that nobody holds; None if there is nothing to take. One statement: two never get the same."""
    rules = rule(SHARD_RULES, "claim")
    free = or_(Shard.state.in_(rules.sources), and_(Shard.state == ShardState.RUNNING, is_expired()))
    row = session.execute(
        update(Shard)
        .where(Shard.id == which, free, is_wanted())
        .values(
            state=rules.target,
            fence=Shard.fence + 1,
            attempts=Shard.attempts + 1,
            holder=holder,
            kept_on=None,
            kept_until=None,
            lease_until=_in(lease_s),
            done_frames=0,
            n_paces=0,
            seconds_per_frame=None,
            seconds_per_frame_std=None,
            started_at=func.clock_timestamp(),
        )
        .returning(
            Shard.id,
            Shard.experiment_id,
            Shard.run_id,
            Shard.task,
            Shard.start_frame,
            Shard.stop_frame,
            Shard.input_key,
            Shard.fence,
            Shard.attempts,
            Shard.n_errors,
        )
    ).one_or_none()
    return None if row is None else Claim(*row)


def is_wanted() -> ColumnElement[bool]:
    """That a shard is still to be done, and was not tried too often."""
    return and_(Shard.attempts < MAX_ATTEMPTS, or_(Shard.run_id.is_(None), _run_goes_on()))


def held(claim: Claim) -> tuple[ColumnElement[bool], ...]:
    """That the shard is still ours, as conditions of a statement."""
    return Shard.id == claim.shard_id, Shard.fence == claim.fence, Shard.state == ShardState.RUNNING


def is_expired() -> ColumnElement[bool]:
    """That the holder was silent for too long."""
    return Shard.lease_until < func.clock_timestamp()


def release(session: Session, *conditions: ColumnElement[bool], values: dict[str, Any] | None = None) -> int:
    """Give shards back that were running; whoever held them is fenced off. Returns how many."""
    rules = rule(SHARD_RULES, "release")
    given_back = session.execute(
        update(Shard)
        .where(Shard.state.in_(rules.sources), *conditions)
        .values(
            {
                "state": rules.target,
                "fence": Shard.fence + 1,
                "lease_until": None,
                "holder": None,
                "done_frames": 0,
                **(values or {}),
            }
        )
        .returning(Shard.id)
    )
    return len(given_back.all())


class Lease:
    """Keeps a claim alive while work goes on: a `dropflow.progress.Progress` that the stages call after each frame."""

    def __init__(
        self, sessions: Sessions, claim: Claim, *, lease_s: float, beat: Callable[[], None] = lambda: None
    ) -> None:
        self.claim = claim
        self._sessions, self._lease_s, self._beat = sessions, lease_s, beat
        self._renewed = self._spoke = time.monotonic()
        self._took_s = 0.0
        self._n_frames = claim.stop_frame - claim.start_frame
        self._begun_at: int | None = None
        self.pace = Pace(time.monotonic())
        """Of the frames so far."""

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Note progress, renew in time, and raise `Cancelled` or `LeaseLost` if the work is not wanted."""
        self._spoke = time.monotonic()
        n_done = (self._n_frames or total) * done / max(total, 1)
        is_first, is_last = self._begun_at is None, done >= total
        self._begun_at = done if self._begun_at is None else self._begun_at
        pause_s = min(max(_SHORTEST_RENEWAL_S, _RENEWAL_SHARE * self._took_s), self._lease_s / 4)
        is_due = is_last or time.monotonic() - self._renewed > pause_s
        if is_first or is_due:
            self.pace.mark(n_done, time.monotonic(), is_last=is_last)
        if is_due:
            # Tracking that has saved its state since it was claimed gets somewhere, however often it is broken off.
            is_fruitful = stage == "track" and done - self._begun_at > FRAMES_PER_PART
            self.renew(done_frames=int(n_done), is_fruitful=is_fruitful)

    def alive(self, stage: str, done: int, total: int) -> None:  # noqa: ARG002 - the contract's
        """The same for work whose progress is not in frames."""
        self._spoke = time.monotonic()
        if time.monotonic() - self._renewed > self._lease_s / 4:
            self.renew()

    @contextmanager
    def kept(self, longest_step_s: float) -> Iterator[None]:
        """Renew beside the work while the context lasts, unless the work has said nothing for `longest_step_s`.

        A first frame for which code is compiled, or a sum over a whole film, may take longer than a lease: that is
        short, so that the work of those who died is soon taken up. Whoever is stopped renews nothing, all threads being
        stopped with it.
        """
        is_done = threading.Event()

        def keep() -> None:
            while not is_done.wait(self._lease_s / 4) and time.monotonic() - self._spoke < longest_step_s:
                with suppress(LeaseLost, Cancelled):  # the work hears of it when it next says how far it is
                    self._renew_now(None, is_fruitful=False)

        keeper = threading.Thread(target=keep, name="lease", daemon=True)
        keeper.start()
        try:
            yield
        finally:
            is_done.set()
            keeper.join()

    def renew(self, done_frames: int | None = None, *, is_fruitful: bool = False) -> None:
        """Tell that we live, and hear whether we shall stop, in one statement."""
        self._spoke = time.monotonic()
        self._renew_now(done_frames, is_fruitful=is_fruitful)

    def _renew_now(self, done_frames: int | None, *, is_fruitful: bool) -> None:
        self._beat()
        began_s = time.monotonic()
        try:
            with self._sessions.begin() as session:
                is_cancelled = self._renew(session, done_frames, is_fruitful=is_fruitful)
        except OperationalError as problem:
            # Postgres may be starting again. Our claim holds as long as nobody could take it.
            log.warning(
                "lease not renewed",
                run=str(self.claim.run_id) if self.claim.run_id else None,
                shard=str(self.claim.shard_id),
                reason=reason_of(problem),
            )
            if time.monotonic() - self._renewed > self._lease_s:
                raise LeaseLost from None
            return
        self._renewed = time.monotonic()
        self._took_s = self._renewed - began_s
        if is_cancelled:
            raise Cancelled("The run was cancelled.")

    def _renew(self, session: Session, done_frames: int | None, *, is_fruitful: bool) -> bool:
        values: dict[str, Any] = {"lease_until": _in(self._lease_s)}
        if done_frames is not None:
            values |= {
                "done_frames": done_frames,
                "n_paces": self.pace.n_samples,
                "seconds_per_frame": self.pace.mean_s,
                "seconds_per_frame_std": self.pace.std_s,
            }
        if is_fruitful:
            values["attempts"] = 1
        is_cancelled = (
            select(Run.cancel_requested_at.is_not(None))
            .where(Run.id == Shard.run_id)
            .correlate(Shard)
            .scalar_subquery()
        )
        told = [] if done_frames is None else announcing(*self.claim.topics)
        # A renewal that a crash of Postgres forgets was made in vain, as if it had come before: it waits for no disk,
        # which all who commit would wait for one after the other, as all that is told goes out in one order.
        hasty = func.set_config("synchronous_commit", "off", True)
        row = session.execute(
            update(Shard).where(*held(self.claim)).values(values).returning(is_cancelled, hasty, *told)
        ).one_or_none()
        if row is None:
            raise LeaseLost
        return bool(row[0])


def _run_goes_on() -> ColumnElement[bool]:
    goes_on = exists().where(
        Run.id == Shard.run_id, Run.state.in_(ACTIVE_RUN_STATES), Run.cancel_requested_at.is_(None)
    )
    return goes_on.correlate(Shard)


def _in(seconds: float) -> ColumnElement[Any]:
    return func.clock_timestamp() + timedelta(seconds=seconds)
