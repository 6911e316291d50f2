"""People whom a provider vouches for: their account, and the groups that its claims put them into."""

from typing import Any

from sqlalchemy.orm import Session

from backend.groups import service as groups
from backend.models import Person, Right
from backend.people import repository, service
from backend.people.errors import EmailTaken, LockedOut
from backend.platform.settings import Settings
from backend.platform.texts import is_storable

_LONGEST = 200


def person_of(session: Session, settings: Settings, claims: dict[str, Any]) -> Person:
    """The person of these claims, with an account made at their first time, in the groups that the claims say."""
    issuer, subject = str(settings.oidc_issuer), str(claims["sub"])
    person = repository.by_subject(session, issuer, subject) or _new(session, issuer, subject, claims)
    if person.disabled_at is not None:
        raise LockedOut
    _put_into_groups(session, settings, person, claims)
    return person


def _new(session: Session, issuer: str, subject: str, claims: dict[str, Any]) -> Person:
    """An address alone makes nobody who had an account before: whoever names it first would get theirs."""
    email = _text(claims.get("email")).lower() or None
    if email is not None and repository.by_email(session, email) is not None:
        raise EmailTaken
    name = _text(claims.get("name")) or (email or subject).partition("@")[0]
    person = Person(name=name[:_LONGEST], email=email, oidc_issuer=issuer, oidc_subject=subject)
    session.add(person)
    session.flush()
    service.give_own_space(session, person)
    return person


def _put_into_groups(session: Session, settings: Settings, person: Person, claims: dict[str, Any]) -> None:
    """Groups that stand in OIDC_GROUPS are as the provider says, each time; all others stay as they are."""
    said = claims.get(settings.oidc_groups_claim) or []
    held = {said} if isinstance(said, str) else {str(value) for value in said}
    wanted: dict[str, Right | None] = {}
    for value, place in settings.oidc_groups.items():
        name, _, right = place.rpartition(":")
        rights = [found for found in (wanted.get(name), Right(right) if value in held else None) if found]
        wanted[name] = max(rights, key=list(Right).index, default=None)
    for name, given in wanted.items():
        groups.place(session, name, person.id, given)


def _text(value: Any) -> str:
    text = " ".join(str(value or "").split())
    return text if is_storable(text) else ""
