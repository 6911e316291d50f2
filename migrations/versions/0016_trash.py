"""The trash: experiments, runs and frames that were deleted and can be brought back."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0016"
down_revision: str | None = "0015"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None

_BEFORE = ("empty", "uploading", "indexing", "ready", "rejected")


def _allow(*states: str) -> None:
    op.drop_constraint(op.f("ck_stack_known_state"), "stack", type_="check")
    known = ", ".join(f"'{state}'" for state in states)
    op.create_check_constraint(op.f("ck_stack_known_state"), "stack", f"state IN ({known})")


def upgrade() -> None:
    for table in ("experiment", "run", "stack"):
        op.add_column(table, sa.Column("trashed_at", sa.DateTime(timezone=True), nullable=True))
        op.add_column(table, sa.Column("trashed_by", sa.String(length=200), nullable=True))
        op.add_column(table, sa.Column("trashed_bytes", sa.BigInteger(), server_default="0", nullable=False))
    _allow(*_BEFORE, "expired")


def downgrade() -> None:
    op.execute("UPDATE stack SET state = 'ready' WHERE state = 'expired' AND trashed_at IS NOT NULL")
    op.execute("UPDATE stack SET state = 'empty' WHERE state = 'expired'")
    _allow(*_BEFORE)
    for table in ("experiment", "run", "stack"):
        for column in ("trashed_at", "trashed_by", "trashed_bytes"):
            op.drop_column(table, column)
