"""Keys of creations that may be asked for twice; indexes of long lists."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0004"
down_revision: str | None = "0003"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.create_table(
        "idempotency_key",
        sa.Column("person_id", sa.Uuid(), nullable=False),
        sa.Column("key", sa.String(length=255), nullable=False),
        sa.Column("request_sha256", sa.String(length=64), nullable=False),
        sa.Column("made_id", sa.Uuid(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.ForeignKeyConstraint(
            ["person_id"], ["person.id"], name=op.f("fk_idempotency_key_person_id_person"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("person_id", "key", name=op.f("pk_idempotency_key")),
    )
    op.create_index(op.f("ix_idempotency_key_created_at"), "idempotency_key", ["created_at"])
    op.create_index("ix_experiment_newest", "experiment", ["group_id", "created_at", "id"])
    op.drop_index(op.f("ix_experiment_group_id"), "experiment")
    op.create_index("ix_run_newest", "run", ["created_at", "id"])


def downgrade() -> None:
    op.drop_index("ix_run_newest", "run")
    op.create_index(op.f("ix_experiment_group_id"), "experiment", ["group_id"])
    op.drop_index("ix_experiment_newest", "experiment")
    op.drop_table("idempotency_key")
