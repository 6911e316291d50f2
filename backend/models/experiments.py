"""Experiments, their stacks and the files these came as."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Index, String, UniqueConstraint, func
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, Json, one_of
from backend.models.people import Group
from backend.models.states import StackState
from backend.models.trashed import Trashed


class Experiment(Identified, Dated, Trashed, Base):
    """What was filmed. `document` is the content of experiment.yaml, validated by the library."""

    __tablename__ = "experiment"
    __table_args__ = (Index("ix_experiment_newest", "group_id", "created_at", "id"),)

    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id"))
    document: Mapped[Json]
    updated_at: Mapped[datetime] = mapped_column(server_default=func.now(), onupdate=func.now())

    group: Mapped[Group] = relationship(lazy="joined", innerjoin=True)
    stack: Mapped["Stack"] = relationship(
        lazy="joined", innerjoin=True, back_populates="experiment", passive_deletes=True, cascade="all"
    )


class Stack(Trashed, Base):
    """The frames of an experiment: empty at first, then what the index found."""

    __tablename__ = "stack"

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"), primary_key=True)
    state: Mapped[StackState] = mapped_column(one_of(StackState), default=StackState.EMPTY)
    n_frames: Mapped[int | None]
    rows: Mapped[int | None]
    columns: Mapped[int | None]
    dtype: Mapped[str | None] = mapped_column(String(20))
    duration_s: Mapped[float | None]
    checksum: Mapped[str | None] = mapped_column(String(64))
    """Of the frames' content: changes when any frame does."""
    index_key: Mapped[str | None] = mapped_column(String(300))
    """Object with times and checksums of all frames."""
    problem: Mapped[Json | None]
    warnings: Mapped[list[str]] = mapped_column(default=list)
    broken_frames: Mapped[list[int]] = mapped_column(default=list, server_default="[]")
    """Those of the files that cannot be read and are left out."""
    confirmed_at: Mapped[datetime | None]
    """When a person said that order, times and scale are right."""
    confirmation: Mapped[Json | None]
    """`by` whom, and of which `facts`."""

    experiment: Mapped[Experiment] = relationship(back_populates="stack")


class File(Identified, Dated, Base):
    """One uploaded file. Its name is what people called it; where it is kept, we decide."""

    __tablename__ = "file"
    __table_args__ = (UniqueConstraint("experiment_id", "role", "name"),)

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"))
    role: Mapped[str] = mapped_column(String(20))
    name: Mapped[str] = mapped_column(String(1000))
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(String(64))
    store_key: Mapped[str] = mapped_column(String(1200), index=True)
    """An object, or a prefix that ends in ``/`` with the pieces of one; small files that came together share one.
    ``outside:ROOT/path`` is a file that stays where it was imported from."""
    start_byte: Mapped[int] = mapped_column(BigInteger, default=0, server_default="0")
    """Where its bytes begin there."""
    version: Mapped[str | None] = mapped_column(String(100))
    """Of a file outside the store, as it was when it was imported: differs when it is written."""


class ImportMode(StrEnum):
    """What becomes of files that are imported."""

    COPY = "copy"
    REFERENCE = "reference"


class Import(Dated, Base):
    """Frames that come from a folder of the server or a prefix of S3, and how far that is."""

    __tablename__ = "import_"

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"), primary_key=True)
    root: Mapped[str] = mapped_column(String(50))
    """The name of a place on the list of the settings."""
    path: Mapped[str] = mapped_column(String(1000))
    """Below it: a folder, or one file."""
    mode: Mapped[ImportMode] = mapped_column(one_of(ImportMode))
    n_files: Mapped[int]
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    done_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    bytes_per_s: Mapped[float | None]
    finished_at: Mapped[datetime | None]
