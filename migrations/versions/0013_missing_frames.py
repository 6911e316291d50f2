"""Frames of a stack that cannot be read and are left out."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0013"
down_revision: str | None = "0012"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    frames = postgresql.JSONB(none_as_null=True, astext_type=sa.Text())
    op.add_column("stack", sa.Column("broken_frames", frames, server_default="[]", nullable=False))


def downgrade() -> None:
    op.drop_column("stack", "broken_frames")
