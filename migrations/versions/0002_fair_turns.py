"""For whom work is done, how fast it goes, and which frames are missing."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0002"
down_revision: str | None = "0001"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.create_table(
        "speed",
        sa.Column("kind", sa.String(length=50), nullable=False),
        sa.Column("seconds_per_megapixel", sa.Double(), nullable=False),
        sa.Column("measured_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.PrimaryKeyConstraint("kind", name=op.f("pk_speed")),
    )
    for table in ("run", "shard"):
        op.add_column(table, sa.Column("person_id", sa.Uuid(), nullable=True))
        op.create_foreign_key(
            op.f(f"fk_{table}_person_id_person"), table, "person", ["person_id"], ["id"], ondelete="SET NULL"
        )
    op.create_index(op.f("ix_shard_person_id_shard_started_at"), "shard", ["person_id", "started_at"])
    op.add_column("run", sa.Column("source_digest", sa.String(length=64), nullable=True))
    op.add_column("run", sa.Column("stack_checksum", sa.String(length=64), nullable=True))
    op.add_column("shard", sa.Column("n_paces", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("shard", sa.Column("seconds_per_frame", sa.Double(), nullable=True))
    op.add_column("shard", sa.Column("seconds_per_frame_std", sa.Double(), nullable=True))
    op.add_column("product", sa.Column("film_key", sa.String(length=64), nullable=True))
    op.add_column("product", sa.Column("start_frame", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("product", sa.Column("stop_frame", sa.Integer(), nullable=False, server_default="0"))
    missing_frames = postgresql.JSONB(none_as_null=True, astext_type=sa.Text())
    op.add_column("product", sa.Column("missing_frames", missing_frames, nullable=False, server_default="[]"))
    op.create_index(op.f("ix_product_experiment_id_product_film_key"), "product", ["experiment_id", "film_key"])
    # The defaults were for the rows that are there.
    for table, column in (
        ("shard", "n_paces"),
        ("product", "start_frame"),
        ("product", "stop_frame"),
        ("product", "missing_frames"),
    ):
        op.alter_column(table, column, server_default=None)


def downgrade() -> None:
    op.drop_index(op.f("ix_product_experiment_id_product_film_key"), table_name="product")
    for column in ("film_key", "start_frame", "stop_frame", "missing_frames"):
        op.drop_column("product", column)
    for column in ("n_paces", "seconds_per_frame", "seconds_per_frame_std"):
        op.drop_column("shard", column)
    op.drop_column("run", "stack_checksum")
    op.drop_column("run", "source_digest")
    op.drop_index(op.f("ix_shard_person_id_shard_started_at"), table_name="shard")
    for table in ("shard", "run"):
        op.drop_constraint(op.f(f"fk_{table}_person_id_person"), table, type_="foreignkey")
        op.drop_column(table, "person_id")
    op.drop_table("speed")
