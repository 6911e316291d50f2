"""Webhooks, e-mail, and the notices that are sent to both."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0010"
down_revision: str | None = "0009"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def _json() -> postgresql.JSONB:
    return postgresql.JSONB(none_as_null=True, astext_type=sa.Text())


def _one_of(name: str, *states: str) -> sa.Enum:
    return sa.Enum(*states, name=name, native_enum=False, create_constraint=True, length=20)


def upgrade() -> None:
    op.add_column("person", sa.Column("is_mailed", sa.Boolean(), nullable=False, server_default=sa.true()))
    op.alter_column("person", "is_mailed", server_default=None)
    op.create_table(
        "webhook",
        sa.Column("group_id", sa.Uuid(), nullable=False),
        sa.Column("address", sa.String(length=2000), nullable=False),
        sa.Column("events", _json(), nullable=False),
        sa.Column("salt", sa.String(length=64), nullable=False),
        sa.Column("is_active", sa.Boolean(), nullable=False),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.ForeignKeyConstraint(
            ["group_id"], ["group_.id"], name=op.f("fk_webhook_group_id_group_"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_webhook")),
    )
    op.create_index(op.f("ix_webhook_group_id"), "webhook", ["group_id"], unique=False)
    op.create_table(
        "notice",
        sa.Column("webhook_id", sa.Uuid(), nullable=True),
        sa.Column("person_id", sa.Uuid(), nullable=True),
        sa.Column("run_id", sa.Uuid(), nullable=True),
        sa.Column(
            "event", _one_of("known_event", "run.completed", "run.failed", "run.cancelled", "test"), nullable=False
        ),
        sa.Column("about", _json(), nullable=False),
        sa.Column("resend_of", sa.Uuid(), nullable=True),
        sa.Column("state", _one_of("known_state", "waiting", "delivered", "failed"), nullable=False),
        sa.Column("n_tries", sa.Integer(), nullable=False),
        sa.Column("tries", _json(), nullable=False),
        sa.Column("due_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("held_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.CheckConstraint("(webhook_id IS NULL) <> (person_id IS NULL)", name=op.f("ck_notice_one_receiver")),
        sa.ForeignKeyConstraint(
            ["webhook_id"], ["webhook.id"], name=op.f("fk_notice_webhook_id_webhook"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["person_id"], ["person.id"], name=op.f("fk_notice_person_id_person"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["run_id"], ["run.id"], name=op.f("fk_notice_run_id_run"), ondelete="SET NULL"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_notice")),
        sa.UniqueConstraint("person_id", "run_id", "event", name=op.f("uq_notice_person_id_run_id_event")),
    )
    op.create_index("ix_notice_due", "notice", ["due_at"], postgresql_where=sa.text("state = 'waiting'"))
    op.create_index(op.f("ix_notice_run_id"), "notice", ["run_id"])
    op.create_index(
        op.f("ix_notice_webhook_id_notice_created_at_notice_id"), "notice", ["webhook_id", "created_at", "id"]
    )
    op.create_index(
        "uq_notice_of_run",
        "notice",
        ["webhook_id", "run_id", "event"],
        unique=True,
        postgresql_where=sa.text("resend_of IS NULL"),
    )


def downgrade() -> None:
    op.drop_table("notice")
    op.drop_table("webhook")
    op.drop_column("person", "is_mailed")
