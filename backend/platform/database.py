"""Sessions. Whoever opens one commits once: the request, the task, the reconciler's round."""

from collections.abc import Callable
from typing import Any

from sqlalchemy import Engine, create_engine, event
from sqlalchemy.orm import Session, sessionmaker

Sessions = sessionmaker[Session]
"""`with sessions.begin() as session:` is one transaction."""

_AFTER_COMMIT = "after_commit"


def make_engine(url: str, *, application: str, pool_size: int = 5, max_overflow: int = 0) -> Engine:
    """Connections that are checked before use, so that a restarted Postgres costs no error."""
    return create_engine(
        url,
        pool_size=pool_size,
        max_overflow=max_overflow,
        pool_pre_ping=True,
        connect_args={"application_name": application, "connect_timeout": 5, "prepare_threshold": None},
    )


def make_sessions(engine: Engine) -> Sessions:
    """A factory of sessions on `engine`."""
    sessions = sessionmaker(engine, expire_on_commit=False)
    event.listen(sessions, "after_commit", _run_callbacks)
    event.listen(sessions, "after_rollback", _forget_callbacks)
    return sessions


def after_commit(session: Session, callback: Callable[[], Any]) -> None:
    """Call `callback` once the transaction is safe: messages never speak of rows that are not there."""
    session.info.setdefault(_AFTER_COMMIT, []).append(callback)


def _run_callbacks(session: Session) -> None:
    for callback in session.info.pop(_AFTER_COMMIT, []):
        callback()


def _forget_callbacks(session: Session) -> None:
    session.info.pop(_AFTER_COMMIT, None)
