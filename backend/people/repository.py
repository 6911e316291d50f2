"""Queries about people and the browsers they are signed in with."""

from collections.abc import Sequence
from datetime import datetime
from uuid import UUID

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from backend.models import BrowserSession, Person, ShareLink, SignInLink
from backend.platform.secrets import hashed


def find(session: Session, person_id: UUID) -> Person | None:
    """One person."""
    return session.get(Person, person_id)


def by_email(session: Session, email: str) -> Person | None:
    """The person who has this address."""
    return session.scalar(select(Person).where(Person.email == email))


def by_subject(session: Session, issuer: str, subject: str) -> Person | None:
    """The person whom a provider calls so."""
    return session.scalar(select(Person).filter_by(oidc_issuer=issuer, oidc_subject=subject))


def everybody(session: Session) -> Sequence[Person]:
    """All people, by name."""
    return session.scalars(select(Person).order_by(func.lower(Person.name), Person.id)).all()


def administrators(session: Session) -> Sequence[Person]:
    """Those who can sign in and look after the service; nobody else changes who that is meanwhile."""
    query = select(Person).where(Person.is_administrator, Person.disabled_at.is_(None), Person.email.is_not(None))
    return session.scalars(query.with_for_update(key_share=True)).all()


def has_administrator(session: Session) -> bool:
    """Whether anybody can look after the service."""
    query = select(Person.id).where(Person.is_administrator, Person.disabled_at.is_(None), Person.email.is_not(None))
    return session.scalar(query.limit(1)) is not None


def sessions(session: Session, person_id: UUID) -> Sequence[BrowserSession]:
    """Where a person is signed in, latest use first."""
    query = select(BrowserSession).where(BrowserSession.person_id == person_id, BrowserSession.expires_at > func.now())
    return session.scalars(query.order_by(BrowserSession.used_at.desc())).all()


def session_of(session: Session, secret: str) -> BrowserSession | None:
    """The session that a cookie stands for."""
    return session.scalar(select(BrowserSession).where(BrowserSession.secret_hash == hashed(secret)))


def end_sessions(session: Session, person_id: UUID, *, but: UUID | None = None) -> None:
    """Sign a person out everywhere, or everywhere else."""
    query = delete(BrowserSession).where(BrowserSession.person_id == person_id)
    session.execute(query if but is None else query.where(BrowserSession.id != but))


def end_session(session: Session, person_id: UUID, session_id: UUID) -> bool:
    """Sign a person out in one browser; whether they were in."""
    query = delete(BrowserSession).where(BrowserSession.person_id == person_id, BrowserSession.id == session_id)
    return session.execute(query.returning(BrowserSession.id)).first() is not None


def forget_expired(session: Session, now: datetime) -> None:
    """Remove what lets nobody in any more."""
    for table in (BrowserSession, SignInLink):
        session.execute(delete(table).where(table.expires_at < now))


def share_link(session: Session, secret: str) -> ShareLink | None:
    """The link to a shared run, as long as it works."""
    query = select(ShareLink).where(ShareLink.secret_hash == hashed(secret), ShareLink.expires_at > func.now())
    return session.scalar(query)


def use_link(session: Session, secret: str) -> UUID | None:
    """The person of a link that nobody used yet: of two who show it at once, one gets in."""
    query = (
        update(SignInLink)
        .where(SignInLink.secret_hash == hashed(secret), SignInLink.used_at.is_(None))
        .where(SignInLink.expires_at > func.now())
        .values(used_at=func.now())
        .returning(SignInLink.person_id)
    )
    return session.scalar(query)
