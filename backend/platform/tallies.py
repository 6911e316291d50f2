"""Counting what happens over the life of a service, in the transaction in which it does."""

from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from backend.models import Tally


def tally(session: Session, name: str) -> None:
    """Count one more of `name`. For what is rare: all who count the same wait for each other."""
    one_more = insert(Tally).values(name=name, count=1)
    session.execute(one_more.on_conflict_do_update(index_elements=[Tally.name], set_={"count": Tally.count + 1}))
