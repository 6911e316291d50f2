"""Tracking that gave way to others stays with the machine that has its state."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0014"
down_revision: str | None = "0013"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.add_column("shard", sa.Column("kept_on", sa.String(length=200), nullable=True))
    op.add_column("shard", sa.Column("kept_until", sa.DateTime(timezone=True), nullable=True))


def downgrade() -> None:
    op.drop_column("shard", "kept_until")
    op.drop_column("shard", "kept_on")
