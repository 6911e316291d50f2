"""How Alembic reaches the database: DATABASE_URL, one transaction, and no waiting for locks of a running service."""

import os

from alembic import context
from sqlalchemy import Connection, create_engine, text

from backend.models import Base
from backend.platform.settings import with_driver


def run() -> None:
    """Bring the database from its form to the one asked for, in the transaction that is given or in one of its own."""
    given: Connection | None = context.config.attributes.get("connection")
    if given is not None:
        _migrate(given)
        return
    engine = create_engine(with_driver(os.environ["DATABASE_URL"]))
    with engine.connect() as connection:
        # Two instances that start at once migrate one after the other.
        connection.execute(text("SELECT pg_advisory_lock(hashtext('dropflow.migrations'))"))
        connection.execute(text("SET lock_timeout = '5s'"))
        connection.commit()
        _migrate(connection)
    engine.dispose()


def _migrate(connection: Connection) -> None:
    context.configure(connection=connection, target_metadata=Base.metadata, compare_type=True)
    with context.begin_transaction():
        context.run_migrations()


run()
