"""A person has no choice about e-mail as long as none is sent."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0009"
down_revision: str | None = "0008"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.drop_column("person", "is_mailed")


def downgrade() -> None:
    op.add_column("person", sa.Column("is_mailed", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.alter_column("person", "is_mailed", server_default=None)
