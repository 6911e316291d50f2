"""Runs, their stages, the shards workers claim, and the products these leave."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Index, LargeBinary, String, UniqueConstraint, func
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, Json, one_of
from backend.models.experiments import Experiment
from backend.models.states import RunState, ShardState, StageState
from backend.models.trashed import Trashed


class Run(Identified, Dated, Trashed, Base):
    """One analysis of one experiment with one set of parameters."""

    __tablename__ = "run"
    __table_args__ = (UniqueConstraint("experiment_id", "number"), Index("ix_run_newest", "created_at", "id"))

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"))
    person_id: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="SET NULL"))
    """Who started it."""
    number: Mapped[int]
    state: Mapped[RunState] = mapped_column(one_of(RunState), default=RunState.QUEUED)
    parameters: Mapped[Json]
    document: Mapped[Json]
    """The experiment as it was described when the run began."""
    version: Mapped[str] = mapped_column(String(50))
    source_digest: Mapped[str | None] = mapped_column(String(64))
    """Checksum of the code that worked on it."""
    stack_checksum: Mapped[str | None] = mapped_column(String(64))
    """Of the frames that it analyses."""
    problem: Mapped[Json | None]
    summary: Mapped[Json | None]
    warnings: Mapped[list[str]] = mapped_column(default=list)
    cancel_requested_at: Mapped[datetime | None]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]

    experiment: Mapped[Experiment] = relationship()
    stages: Mapped[list["Stage"]] = relationship(
        order_by="Stage.position", lazy="selectin", cascade="all", passive_deletes=True
    )


class Stage(Base):
    """One of the steps of a run, as people see it."""

    __tablename__ = "stage"

    run_id: Mapped[UUID] = mapped_column(ForeignKey("run.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(20), primary_key=True)
    position: Mapped[int]
    state: Mapped[StageState] = mapped_column(one_of(StageState), default=StageState.WAITING)
    total_frames: Mapped[int]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class Product(Identified, Dated, Base):
    """What one piece of work made, addressed by what went in; runs whose input is the same share it."""

    __tablename__ = "product"
    __table_args__ = (Index(None, "experiment_id", "input_key"), Index(None, "experiment_id", "film_key"))

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"))
    task: Mapped[str] = mapped_column(String(20))
    input_key: Mapped[str] = mapped_column(String(64))
    film_key: Mapped[str | None] = mapped_column(String(64))
    """The same for all ranges of frames that went through the same detection, however a film was divided."""
    start_frame: Mapped[int] = mapped_column(default=0)
    stop_frame: Mapped[int] = mapped_column(default=0)
    prefix: Mapped[str] = mapped_column(String(300))
    """Where its objects are."""
    files: Mapped[list[Json]]
    """`name`, `size_bytes` and `media_type` of each that people can fetch."""
    summary: Mapped[Json | None]
    """What the run that this completes shows of it."""


class FrameSummary(Base):
    """What dashboards show of each frame of one product, packed; they merge and coarsen it."""

    __tablename__ = "frame_summary"

    product_id: Mapped[UUID] = mapped_column(ForeignKey("product.id", ondelete="CASCADE"), primary_key=True)
    sizes: Mapped[bytes] = mapped_column(LargeBinary)
    """Droplets by radius: `dropflow.statistics.histograms.FrameHistograms`."""
    flow: Mapped[bytes | None] = mapped_column(LargeBinary)
    """`dropflow.statistics.flow_moments.FlowMoments`, once droplets were tracked."""


class Shard(Identified, Dated, Base):
    """One piece of work, which one worker at a time holds by a lease; the fence tells holders apart.

    The ingest of a stack has no run. Frames are `start_frame` <= frame < `stop_frame`.
    """

    __tablename__ = "shard"
    __table_args__ = (
        UniqueConstraint("run_id", "task", "start_frame"),
        Index(None, "experiment_id"),
        Index("ix_shard_open", "state", "lease_until", postgresql_where="state IN ('queued', 'running')"),
        Index(None, "person_id", "started_at"),
        Index("ix_shard_waiting", "run_id", "start_frame", postgresql_where="state = 'queued'"),
        Index("ix_shard_at_work", "person_id", postgresql_where="state = 'running'"),
    )

    experiment_id: Mapped[UUID] = mapped_column(ForeignKey("experiment.id", ondelete="CASCADE"))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("run.id", ondelete="CASCADE"))
    person_id: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="SET NULL"))
    """For whom it is done: workers are shared fairly between people."""
    task: Mapped[str] = mapped_column(String(20))
    start_frame: Mapped[int] = mapped_column(default=0)
    stop_frame: Mapped[int] = mapped_column(default=0)
    state: Mapped[ShardState] = mapped_column(one_of(ShardState), default=ShardState.QUEUED)
    done_frames: Mapped[int] = mapped_column(default=0)
    n_paces: Mapped[int] = mapped_column(default=0)
    """How many stretches of work were timed."""
    seconds_per_frame: Mapped[float | None]
    """Their mean."""
    seconds_per_frame_std: Mapped[float | None]
    """How much they differ."""
    input_key: Mapped[str | None] = mapped_column(String(64))
    product_id: Mapped[UUID | None] = mapped_column(ForeignKey("product.id"), index=True)
    is_reused: Mapped[bool] = mapped_column(default=False)
    """Its product was there already, made for another run."""
    fence: Mapped[int] = mapped_column(default=0)
    attempts: Mapped[int] = mapped_column(default=0)
    n_errors: Mapped[int] = mapped_column(default=0)
    """How often it met an error that nobody expected."""
    holder: Mapped[str | None] = mapped_column(String(200))
    kept_on: Mapped[str | None] = mapped_column(String(200))
    """The machine that has its state, after it gave way to others."""
    kept_until: Mapped[datetime | None]
    """So long no other machine takes it."""
    lease_until: Mapped[datetime | None]
    sent_at: Mapped[datetime | None]
    """When a message about it last went out."""
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class Speed(Base):
    """How fast this deployment does a kind of work, as measured; shards are sized by it."""

    __tablename__ = "speed"

    kind: Mapped[str] = mapped_column(String(50), primary_key=True)
    seconds_per_megapixel: Mapped[float]
    measured_at: Mapped[datetime] = mapped_column(server_default=func.now(), onupdate=func.now())


class DoomedObject(Dated, Base):
    """A key, or a prefix that ends in ``/``, to be removed from the object store.

    It is written in the transaction that takes the last row away, so that no crash between both leaves bytes behind.
    """

    __tablename__ = "doomed_object"

    key: Mapped[str] = mapped_column(String(300), primary_key=True)


class Tally(Base):
    """How often something has happened since the service was set up."""

    __tablename__ = "tally"

    name: Mapped[str] = mapped_column(String(50), primary_key=True)
    count: Mapped[int] = mapped_column(BigInteger)
