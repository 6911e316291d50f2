"""What can lie in the trash."""

from datetime import datetime

from sqlalchemy import BigInteger, String
from sqlalchemy.orm import Mapped, mapped_column


class Trashed:
    """A row that people can throw away, and bring back until the trash is emptied."""

    trashed_at: Mapped[datetime | None]
    trashed_by: Mapped[str | None] = mapped_column(String(200))
    """None: the service itself, for its time was over."""
    trashed_bytes: Mapped[int] = mapped_column(BigInteger, default=0, server_default="0")
    """What emptying the trash gives back."""
