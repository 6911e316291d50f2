"""Indexes of the shards that wait and of those at work: a turn is found among a million as among ten."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0007"
down_revision: str | None = "0006"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    waiting, at_work = sa.text("state = 'queued'"), sa.text("state = 'running'")
    op.create_index("ix_shard_waiting", "shard", ["run_id", "start_frame"], postgresql_where=waiting)
    op.create_index("ix_shard_at_work", "shard", ["person_id"], postgresql_where=at_work)


def downgrade() -> None:
    op.drop_index("ix_shard_at_work", "shard")
    op.drop_index("ix_shard_waiting", "shard")
