"""Frames that cannot be read are a stack's, not a product's: nothing was ever written there."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0017"
down_revision: str | None = "0016"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.drop_column("product", "missing_frames")


def downgrade() -> None:
    frames = postgresql.JSONB(none_as_null=True, astext_type=sa.Text())
    op.add_column("product", sa.Column("missing_frames", frames, nullable=False, server_default="[]"))
