"""Sends what is to be told to the outside: each notice again and again, at growing distances, until it is taken.

One that is being sent is held for a while, by one process of all that look; whoever dies meanwhile loses only that
while. Of one receiver one notice is sent at a time, so that a slow one holds up others for one try at most.
"""

import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import UUID

import structlog
from sqlalchemy import ColumnElement, delete, func, or_, select, update
from sqlalchemy.dialects.postgresql import distinct_on
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from backend.models import Notice, NoticeState, Person, Webhook
from backend.models.base import Json
from backend.platform.outward import LONGEST_S
from backend.platform.reasons import reason_of
from backend.platform.settings import Settings
from worker import mail, webhooks
from worker.context import Context, make_context
from worker.sending import Outcome

PAUSES_S = (10, 60, 300, 1800, 7200, 21_600, 43_200, 86_400)
"""After a try that failed. A receiver may be away for two days."""

KEPT = timedelta(days=30)
"""How long what was told can be read in the log."""

_HELD = timedelta(seconds=6 * LONGEST_S)
_AT_ONCE = 8
_LOOK_EVERY_S = 1.0
log = structlog.get_logger()


@dataclass(frozen=True)
class Claimed:
    """A notice that this process may send now."""

    id: UUID
    n_tries: int
    """With this one."""
    event: str
    about: Json
    created_at: datetime
    webhook: tuple[str, str] | None
    """Address and salt."""
    mailbox: tuple[str, str] | None
    """Name and e-mail address."""


def tell_round(context: Context, pool: ThreadPoolExecutor) -> int:
    """Send what is due, a few at a time; how many that were."""
    with context.sessions.begin() as session:
        if context.settings.smtp_host is None:
            _forget_mail(session)
        claimed = claim(session)
    for found, outcome in zip(claimed, pool.map(lambda one: _send(context.settings, one), claimed), strict=True):
        with context.sessions.begin() as session:
            record(session, found, outcome)
    return len(claimed)


def claim(session: Session) -> Sequence[Claimed]:
    """Take some that are due, at most one of each receiver."""
    receiver: ColumnElement[UUID] = func.coalesce(Notice.webhook_id, Notice.person_id)
    is_free = or_(Notice.held_until.is_(None), Notice.held_until < func.now())
    held = select(func.coalesce(Notice.webhook_id, Notice.person_id)).where(
        Notice.state == NoticeState.WAITING, Notice.held_until >= func.now()
    )
    first = (
        select(Notice.id, Notice.due_at)
        .where(Notice.state == NoticeState.WAITING, Notice.due_at <= func.now(), is_free, receiver.not_in(held))
        .ext(distinct_on(receiver))
        .order_by(receiver, Notice.due_at)
        .subquery()
    )
    chosen = select(first.c.id).order_by(first.c.due_at).limit(_AT_ONCE)
    taken = session.scalars(
        update(Notice)
        .where(Notice.id.in_(chosen), Notice.state == NoticeState.WAITING, is_free)
        .values(held_until=func.now() + _HELD, n_tries=Notice.n_tries + 1)
        .returning(Notice)
        .execution_options(synchronize_session=False)
    ).all()
    return [_claimed(session, notice) for notice in taken]


def _claimed(session: Session, notice: Notice) -> Claimed:
    webhook = session.get(Webhook, notice.webhook_id) if notice.webhook_id else None
    person = session.get(Person, notice.person_id) if notice.person_id else None
    return Claimed(
        id=notice.id,
        n_tries=notice.n_tries,
        event=notice.event,
        about=notice.about,
        created_at=notice.created_at,
        webhook=(webhook.address, webhook.salt) if webhook else None,
        mailbox=(person.name, person.email) if person and person.email else None,
    )


def _send(settings: Settings, claimed: Claimed) -> Json:
    began_s, at = time.monotonic(), datetime.now(UTC)
    outcome = _sent(settings, claimed)
    return {"at": at.isoformat(), "seconds": round(time.monotonic() - began_s, 3), **outcome}


def _sent(settings: Settings, claimed: Claimed) -> Outcome:
    told: dict[str, Any] = {"event": claimed.event, "about": claimed.about, "at": claimed.created_at}
    if claimed.webhook is not None:
        return webhooks.send(settings, claimed.id, *claimed.webhook, **told)
    if claimed.mailbox is not None:
        return mail.send(settings, claimed.id, *claimed.mailbox, **told)
    return Outcome(status=None, problem="there is no address any more", is_delivered=False, is_final=True)


def record(session: Session, claimed: Claimed, outcome: Json) -> None:
    """Write down how a try ended, unless another process has taken the notice over meanwhile."""
    is_delivered, is_final = outcome.pop("is_delivered"), outcome.pop("is_final")
    values: dict[str, Any] = {"held_until": None, "tries": Notice.tries.concat([outcome])}
    if is_delivered:
        values["state"] = NoticeState.DELIVERED
    elif is_final or claimed.n_tries > len(PAUSES_S):
        values["state"] = NoticeState.FAILED
    else:
        # A little more than the pause, another little for each: those that failed together do not come together.
        values["due_at"] = func.now() + timedelta(seconds=PAUSES_S[claimed.n_tries - 1]) * (1 + func.random() / 5)
    session.execute(update(Notice).where(Notice.id == claimed.id, Notice.n_tries == claimed.n_tries).values(values))


def forget_old(context: Context) -> None:
    """What was told long ago is not kept."""
    with context.sessions.begin() as session:
        session.execute(
            delete(Notice).where(Notice.state != NoticeState.WAITING, Notice.created_at < func.now() - KEPT)
        )


def _forget_mail(session: Session) -> None:
    """There is no server for it: whoever sets one up later does not want to tell of what was long ago."""
    session.execute(delete(Notice).where(Notice.person_id.is_not(None), Notice.state == NoticeState.WAITING))


class Teller:
    """A thread that sends, beside whatever else its process does, with connections of its own."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._tell, name="teller", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End with what is being sent."""
        self._stopping.set()
        self._thread.join(timeout=LONGEST_S + 1)

    def _tell(self) -> None:
        context = make_context(self._settings)
        with ThreadPoolExecutor(_AT_ONCE, "teller") as pool:
            while not self._stopping.is_set():
                try:
                    n_sent = tell_round(context, pool)
                except SQLAlchemyError as problem:
                    log.warning("nothing told", reason=reason_of(problem))
                    n_sent = 0
                if n_sent == 0:
                    self._stopping.wait(_LOOK_EVERY_S)
        context.close()
