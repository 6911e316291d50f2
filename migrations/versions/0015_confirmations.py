"""Who has confirmed order, times and scale of the frames, when, and of what."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0015"
down_revision: str | None = "0014"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.add_column("stack", sa.Column("confirmed_at", sa.DateTime(timezone=True), nullable=True))
    document = postgresql.JSONB(none_as_null=True, astext_type=sa.Text())
    op.add_column("stack", sa.Column("confirmation", document, nullable=True))


def downgrade() -> None:
    op.drop_column("stack", "confirmation")
    op.drop_column("stack", "confirmed_at")
