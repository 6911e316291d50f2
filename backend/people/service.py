"""What can be done with people and their accounts."""

from datetime import UTC, datetime, timedelta
from uuid import UUID

from sqlalchemy import func
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from backend.models import ApiToken, Group, Membership, Person, Right, Scope, SignInLink
from backend.people import passwords, repository, schemas
from backend.people.errors import EmailTaken, LastAdministrator, NoSuchPerson, NoSuchSession, WrongPassword
from backend.platform.audit import tell
from backend.platform.identity import Identity
from backend.platform.secrets import hashed, new_secret
from backend.platform.settings import Settings
from backend.platform.visibility import LOCAL_VIEWER

LOCAL_GROUP_ID = UUID("00000000-0000-4000-8000-000000000002")
LINK_LASTS = timedelta(days=2)
_FOR_EVER = datetime(2200, 1, 1, tzinfo=UTC)


def ensure_local_people(session: Session) -> None:
    """Make the one person and group of a local service, if they are not there yet."""
    person_id = LOCAL_VIEWER.person_id
    rows: list[tuple[type[Person | Group | Membership], dict[str, object]]] = [
        (Person, {"id": person_id, "name": "You", "is_administrator": True}),
        (Group, {"id": LOCAL_GROUP_ID, "name": "Everything here", "personal_of": person_id}),
        (Membership, {"person_id": person_id, "group_id": LOCAL_GROUP_ID, "right": Right.MANAGE}),
    ]
    for table, values in rows:
        session.execute(insert(table).values(values).on_conflict_do_nothing())


def ensure_local_secrets(session: Session, settings: Settings) -> None:
    """Take the token and the link that whoever started us made; what was used stays used."""
    shared = {"person_id": LOCAL_VIEWER.person_id}
    if settings.local_token is not None:
        secret = settings.local_token.get_secret_value()
        token = {"name": "programs of this machine", "beginning": secret[:8], "scope": Scope.ADMIN}
        values = {**shared, **token, "secret_hash": hashed(secret), "expires_at": _FOR_EVER}
        session.execute(insert(ApiToken).values(values).on_conflict_do_nothing())
    if settings.sign_in_token is not None:
        secret = settings.sign_in_token.get_secret_value()
        values = {**shared, "secret_hash": hashed(secret), "expires_at": datetime.now(UTC) + LINK_LASTS}
        session.execute(insert(SignInLink).values(values).on_conflict_do_nothing())


def has_administrator(session: Session) -> bool:
    """Whether anybody can look after the service."""
    return repository.has_administrator(session)


def create(session: Session, *, name: str, email: str, password: str | None = None) -> Person:
    """Make an account, and the space that is this person's own."""
    if repository.by_email(session, email) is not None:
        raise EmailTaken
    person = Person(name=name, email=email, password_hash=passwords.hash_password(password) if password else None)
    session.add(person)
    try:
        session.flush()
    except IntegrityError:  # somebody was quicker with the same address
        raise EmailTaken from None
    give_own_space(session, person)
    return person


def give_own_space(session: Session, person: Person) -> None:
    """Make the group that is one person's own."""
    group = Group(name=person.name, personal_of=person.id)
    session.add(group)
    session.flush()
    session.add(Membership(person_id=person.id, group_id=group.id, right=Right.MANAGE))
    session.flush()


def change_account(session: Session, identity: Identity, change: schemas.ChangeAccount) -> schemas.Person:
    """Change what a person says of themselves."""
    person = get(session, identity.person_id)
    for name, value in change.model_dump(exclude_none=True).items():
        setattr(person, name, value)
    session.flush()
    return shown(person)


def change_password(session: Session, identity: Identity, change: schemas.NewPassword) -> None:
    """Take another password, and sign out every other browser: somebody else may sit at one."""
    person = get(session, identity.person_id)
    has_to_prove = person.password_hash is not None and not _came_by_link(session, identity)
    if has_to_prove and not passwords.is_right(person.password_hash, change.old or ""):
        raise WrongPassword
    person.password_hash = passwords.hash_password(change.new)
    repository.end_sessions(session, person.id, but=identity.session_id)
    session.flush()


def _came_by_link(session: Session, identity: Identity) -> bool:
    """Whether the browser was let in by a link, as whoever forgot their password is."""
    found = repository.sessions(session, _id(identity.person_id))
    return any(one.id == identity.session_id and one.came_by == schemas.Way.LINK for one in found)


def browsers(session: Session, identity: Identity) -> list[schemas.SignedInBrowser]:
    """Where a person is signed in."""
    return [
        schemas.SignedInBrowser(
            id=found.id,
            browser=found.browser,
            came_by=found.came_by,
            created_at=found.created_at,
            used_at=found.used_at,
            is_this=found.id == identity.session_id,
        )
        for found in repository.sessions(session, _id(identity.person_id))
    ]


def end_browser(session: Session, identity: Identity, session_id: UUID) -> None:
    """Sign out in one browser."""
    if not repository.end_session(session, _id(identity.person_id), session_id):
        raise NoSuchSession


def everybody(session: Session) -> list[schemas.KnownPerson]:
    """All people, as an administrator sees them."""
    return [known(person) for person in repository.everybody(session)]


def change_person(session: Session, person_id: UUID, change: schemas.ChangePerson) -> schemas.KnownPerson:
    """Make somebody an administrator, or let them in no more; there is always one who can."""
    person = get(session, person_id)
    administrators = repository.administrators(session)
    if change.is_administrator is not None:
        person.is_administrator = change.is_administrator
    if change.is_disabled is not None:
        person.disabled_at = func.now() if change.is_disabled else None
    session.flush()
    session.refresh(person)
    if administrators == [person] and (not person.is_administrator or person.disabled_at is not None):
        raise LastAdministrator
    if person.disabled_at is not None:
        repository.end_sessions(session, person.id)
    tell(session, name=person.name, **change.model_dump(exclude_none=True))
    return known(person)


def invite_person(session: Session, settings: Settings, new: schemas.NewPerson) -> schemas.PersonLink:
    """Make an account, and the link by which its person comes in to choose a password."""
    person = create(session, name=new.name, email=new.email)
    person.is_administrator = new.is_administrator
    session.flush()
    session.refresh(person)
    tell(session, person_id=person.id, name=person.name)
    return make_link(session, settings, person)


def make_link(session: Session, settings: Settings, person: Person) -> schemas.PersonLink:
    """Make a link that signs somebody in once: their first time, or after they forgot their password."""
    secret = new_secret("in_")
    expires_at = datetime.now(UTC) + LINK_LASTS
    session.add(SignInLink(person_id=person.id, secret_hash=hashed(secret), expires_at=expires_at))
    session.flush()
    link = f"{settings.address}sign-in#{secret}"
    return schemas.PersonLink(person=known(person), link=link, expires_at=expires_at)


def get(session: Session, person_id: UUID | None) -> Person:
    """One person."""
    person = repository.find(session, _id(person_id))
    if person is None:
        raise NoSuchPerson
    return person


def shown(person: Person) -> schemas.Person:
    """A person as they see themselves."""
    return schemas.Person(
        id=person.id,
        name=person.name,
        email=person.email,
        is_administrator=person.is_administrator,
        is_mailed=person.is_mailed,
        has_password=person.password_hash is not None,
    )


def known(person: Person) -> schemas.KnownPerson:
    """A person as an administrator sees them."""
    return schemas.KnownPerson(
        id=person.id,
        name=person.name,
        email=person.email,
        is_administrator=person.is_administrator,
        is_disabled=person.disabled_at is not None,
        signs_in_by=[
            *(["password"] if person.password_hash else []),
            *(["oidc"] if person.oidc_subject else []),
        ],
        created_at=person.created_at,
        seen_at=person.seen_at,
    )


def _id(person_id: UUID | None) -> UUID:
    if person_id is None:
        raise NoSuchPerson
    return person_id
