"""People and groups. On one machine there is one of each."""

from uuid import UUID

from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from backend.models import Group, Membership, Person
from backend.people import repository
from backend.people.errors import NoSuchGroup
from backend.platform.visibility import LOCAL_VIEWER, Viewer

LOCAL_GROUP_ID = UUID("00000000-0000-4000-8000-000000000002")


def ensure_local_people(session: Session) -> None:
    """Make the one person and group of a local service, if they are not there yet."""
    rows: list[tuple[type[Person | Group | Membership], dict[str, object]]] = [
        (Person, {"id": LOCAL_VIEWER.person_id, "name": "You"}),
        (Group, {"id": LOCAL_GROUP_ID, "name": "Everything here"}),
        (Membership, {"person_id": LOCAL_VIEWER.person_id, "group_id": LOCAL_GROUP_ID}),
    ]
    for table, values in rows:
        session.execute(insert(table).values(values).on_conflict_do_nothing())


def group_for_new(session: Session, viewer: Viewer, group_id: UUID | None) -> Group:
    """The group that a new experiment goes to: the one asked for, else this person's first."""
    groups = repository.groups(session, viewer)
    chosen = next((group for group in groups if group_id in (None, group.id)), None)
    if chosen is None:
        raise NoSuchGroup
    return chosen
