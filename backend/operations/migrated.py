"""Whether the database has the form that this version needs."""

import time

from alembic.config import Config
from alembic.script import ScriptDirectory
from sqlalchemy import Engine
from sqlalchemy.exc import SQLAlchemyError

from backend.operations.tables import revision_of
from backend.platform.settings import CHECKOUT

_PAUSE_S = 1.0


def alembic_config() -> Config:
    """The migrations of this checkout or image."""
    return Config(CHECKOUT / "alembic.ini")


def newest_form() -> str | None:
    """The form that this version needs."""
    return ScriptDirectory.from_config(alembic_config()).get_current_head()


def is_migrated_within(engine: Engine, seconds: float) -> bool:
    """Wait at most so long for a database that answers and has the newest form."""
    deadline, form = time.monotonic() + seconds, newest_form()
    while True:
        try:
            with engine.connect() as connection:
                if revision_of(connection) == form:
                    return True
        except SQLAlchemyError:
            pass  # it is starting
        if time.monotonic() >= deadline:
            return False
        time.sleep(_PAUSE_S)
