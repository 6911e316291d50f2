"""Uploads on their way: what was announced, and how much of it is safe."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from backend.models.base import Base, Dated, Identified, Json


class Upload(Identified, Dated, Base):
    """One or several files sent as one row of bytes, which can break off anywhere and go on later.

    Whoever sends holds it for a few seconds at a time; the fence tells senders apart.
    """

    __tablename__ = "upload"
    __table_args__ = (
        Index("ix_upload_open", "experiment_id", postgresql_where="finished_at IS NULL"),
        Index(None, "expires_at"),
    )

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"))
    files: Mapped[list[Json]] = mapped_column(deferred=True)
    """`role`, `name`, `size_bytes` and `sha256` (or null) of each, in the order of their bytes."""
    n_files: Mapped[int]
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    store_key: Mapped[str] = mapped_column(String(300))
    """Where its bytes are: an object that grows, or a prefix that ends in ``/`` with pieces below it."""
    offset_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    """So many bytes are safe."""
    fence: Mapped[int] = mapped_column(default=0)
    held_until: Mapped[datetime | None]
    expires_at: Mapped[datetime]
    finished_at: Mapped[datetime | None]
    """When its files were recorded; it is kept a while so that whoever asks again hears that all is there."""
    problem: Mapped[Json | None]
    """Why it was refused for good."""


class UploadPiece(Base):
    """Bytes of an upload in an object of their own, where objects cannot grow."""

    __tablename__ = "upload_piece"

    upload_id: Mapped[UUID] = mapped_column(ForeignKey("upload.id", ondelete="CASCADE"), primary_key=True)
    start_byte: Mapped[int] = mapped_column(BigInteger, primary_key=True)
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    name: Mapped[str] = mapped_column(String(60))
    """Its key below the upload's own."""
