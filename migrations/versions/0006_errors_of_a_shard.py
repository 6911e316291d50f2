"""How often a shard met an error that nobody expected."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0006"
down_revision: str | None = "0005"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.add_column("shard", sa.Column("n_errors", sa.Integer(), nullable=False, server_default="0"))
    op.alter_column("shard", "n_errors", server_default=None)  # it was for the rows that are there


def downgrade() -> None:
    op.drop_column("shard", "n_errors")
