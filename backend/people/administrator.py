"""`dropflow-server administrator EMAIL`: somebody who looks after the service, and a link for them to come in.

The first administrator of a new service is made so, and who locked themselves out is let in again.
"""

from pydantic import TypeAdapter, ValidationError
from sqlalchemy.orm import Session

from backend.models import Person
from backend.people import repository, schemas, service
from backend.people.errors import BadEmail
from backend.platform.audit import write
from backend.platform.settings import Settings
from backend.platform.visibility import LOCAL_VIEWER


def administrator(session: Session, settings: Settings, *, email: str, name: str | None = None) -> str:
    """Make `email` an administrator, with an account if they have none; the link that signs them in."""
    email = _checked(email)
    called = name or email.partition("@")[0]
    person = repository.by_email(session, email) or _adopted(session, email, called)
    person = person or service.create(session, name=called, email=email)
    person.is_administrator, person.disabled_at = True, None
    session.flush()
    session.refresh(person)
    write(session, action="administrator", about={"email": email}, identity=None, address="command line")
    return service.make_link(session, settings, person).link


def _checked(email: str) -> str:
    try:
        return str(TypeAdapter(schemas.Email).validate_python(email))
    except ValidationError:
        raise BadEmail(email) from None


def _adopted(session: Session, email: str, name: str) -> Person | None:
    """What was made here while this was the machine of one person goes on to be that person's."""
    person = repository.find(session, LOCAL_VIEWER.person_id) if LOCAL_VIEWER.person_id else None
    if person is None or person.email is not None:
        return None
    person.email, person.name = email, name
    return person
