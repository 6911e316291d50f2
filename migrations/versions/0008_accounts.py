"""Accounts, sessions, tokens, invitations, share links and the audit log."""

from collections.abc import Sequence
from uuid import UUID

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects import postgresql

revision: str = "0008"
down_revision: str | None = "0007"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None

LOCAL_PERSON = UUID("00000000-0000-4000-8000-000000000001")
LOCAL_GROUP = UUID("00000000-0000-4000-8000-000000000002")


def upgrade() -> None:
    op.create_table(
        "audit_entry",
        sa.Column("id", sa.BigInteger(), sa.Identity(always=True), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("person_id", sa.Uuid(), nullable=True),
        sa.Column("person_name", sa.String(length=200), nullable=False),
        sa.Column("via", sa.String(length=220), nullable=False),
        sa.Column("address", sa.String(length=60), nullable=False),
        sa.Column("action", sa.String(length=100), nullable=False),
        sa.Column("about", postgresql.JSONB(none_as_null=True, astext_type=sa.Text()), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_audit_entry")),
    )
    op.create_index(op.f("ix_audit_entry_action_audit_entry_id"), "audit_entry", ["action", "id"], unique=False)
    op.create_index(op.f("ix_audit_entry_person_id_audit_entry_id"), "audit_entry", ["person_id", "id"], unique=False)
    op.create_table(
        "api_token",
        sa.Column("person_id", sa.Uuid(), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("beginning", sa.String(length=12), nullable=False),
        sa.Column(
            "scope",
            sa.Enum(
                "read", "submit", "admin", name="known_state", native_enum=False, create_constraint=True, length=20
            ),
            nullable=False,
        ),
        sa.Column("used_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("revoked_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["person_id"], ["person.id"], name=op.f("fk_api_token_person_id_person"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_api_token")),
        sa.UniqueConstraint("secret_hash", name=op.f("uq_api_token_secret_hash")),
    )
    op.create_index(op.f("ix_api_token_person_id"), "api_token", ["person_id"], unique=False)
    op.create_table(
        "browser_session",
        sa.Column("person_id", sa.Uuid(), nullable=False),
        sa.Column("browser", sa.String(length=300), nullable=False),
        sa.Column("came_by", sa.String(length=20), nullable=False),
        sa.Column("used_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["person_id"], ["person.id"], name=op.f("fk_browser_session_person_id_person"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_browser_session")),
        sa.UniqueConstraint("secret_hash", name=op.f("uq_browser_session_secret_hash")),
    )
    op.create_index(op.f("ix_browser_session_person_id"), "browser_session", ["person_id"], unique=False)
    op.create_table(
        "sign_in_link",
        sa.Column("person_id", sa.Uuid(), nullable=False),
        sa.Column("used_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["person_id"], ["person.id"], name=op.f("fk_sign_in_link_person_id_person"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_sign_in_link")),
        sa.UniqueConstraint("secret_hash", name=op.f("uq_sign_in_link_secret_hash")),
    )
    op.create_table(
        "invitation",
        sa.Column("group_id", sa.Uuid(), nullable=False),
        sa.Column(
            "right",
            sa.Enum("view", "edit", "manage", name="known_state", native_enum=False, create_constraint=True, length=20),
            nullable=False,
        ),
        sa.Column("invited_by", sa.Uuid(), nullable=True),
        sa.Column("used_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["group_id"], ["group_.id"], name=op.f("fk_invitation_group_id_group_"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["invited_by"], ["person.id"], name=op.f("fk_invitation_invited_by_person"), ondelete="SET NULL"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_invitation")),
        sa.UniqueConstraint("secret_hash", name=op.f("uq_invitation_secret_hash")),
    )
    op.create_index(op.f("ix_invitation_group_id"), "invitation", ["group_id"], unique=False)
    op.create_table(
        "share_link",
        sa.Column("run_id", sa.Uuid(), nullable=False),
        sa.Column("shared_by", sa.Uuid(), nullable=True),
        sa.Column("used_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.Column("secret_hash", sa.String(length=64), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["run.id"], name=op.f("fk_share_link_run_id_run"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(
            ["shared_by"], ["person.id"], name=op.f("fk_share_link_shared_by_person"), ondelete="SET NULL"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_share_link")),
        sa.UniqueConstraint("secret_hash", name=op.f("uq_share_link_secret_hash")),
    )
    op.create_index(op.f("ix_share_link_run_id"), "share_link", ["run_id"], unique=False)
    op.add_column("group_", sa.Column("personal_of", sa.Uuid(), nullable=True))
    op.add_column("group_", sa.Column("max_bytes", sa.BigInteger(), nullable=True))
    op.add_column("group_", sa.Column("max_active_runs", sa.Integer(), nullable=True))
    op.create_unique_constraint(op.f("uq_group__personal_of"), "group_", ["personal_of"])
    op.create_foreign_key(
        op.f("fk_group__personal_of_person"), "group_", "person", ["personal_of"], ["id"], ondelete="CASCADE"
    )
    op.add_column(
        "membership",
        sa.Column(
            "right",
            sa.Enum("view", "edit", "manage", name="known_state", native_enum=False, create_constraint=True, length=20),
            nullable=False,
            server_default="manage",
        ),
    )
    op.add_column("person", sa.Column("email", sa.String(length=320), nullable=True))
    op.add_column("person", sa.Column("password_hash", sa.String(length=200), nullable=True))
    op.add_column("person", sa.Column("oidc_issuer", sa.String(length=300), nullable=True))
    op.add_column("person", sa.Column("oidc_subject", sa.String(length=300), nullable=True))
    op.add_column("person", sa.Column("is_administrator", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.add_column("person", sa.Column("disabled_at", sa.DateTime(timezone=True), nullable=True))
    op.add_column("person", sa.Column("seen_at", sa.DateTime(timezone=True), nullable=True))
    op.add_column("person", sa.Column("is_mailed", sa.Boolean(), nullable=False, server_default=sa.false()))
    op.create_unique_constraint(op.f("uq_person_email"), "person", ["email"])
    op.create_unique_constraint(op.f("uq_person_oidc_issuer_oidc_subject"), "person", ["oidc_issuer", "oidc_subject"])
    # Whoever was here alone so far goes on as they were; the defaults were for the rows that are there.
    person = sa.table("person", sa.column("id", sa.Uuid()), sa.column("is_administrator"))
    group = sa.table("group_", sa.column("id", sa.Uuid()), sa.column("personal_of", sa.Uuid()))
    op.execute(person.update().where(person.c.id == LOCAL_PERSON).values(is_administrator=True))
    op.execute(group.update().where(group.c.id == LOCAL_GROUP).values(personal_of=LOCAL_PERSON))
    for table, column in (("membership", "right"), ("person", "is_administrator"), ("person", "is_mailed")):
        op.alter_column(table, column, server_default=None)


def downgrade() -> None:
    op.drop_constraint(op.f("uq_person_oidc_issuer_oidc_subject"), "person", type_="unique")
    op.drop_constraint(op.f("uq_person_email"), "person", type_="unique")
    op.drop_column("person", "is_mailed")
    op.drop_column("person", "seen_at")
    op.drop_column("person", "disabled_at")
    op.drop_column("person", "is_administrator")
    op.drop_column("person", "oidc_subject")
    op.drop_column("person", "oidc_issuer")
    op.drop_column("person", "password_hash")
    op.drop_column("person", "email")
    op.drop_column("membership", "right")
    op.drop_constraint(op.f("fk_group__personal_of_person"), "group_", type_="foreignkey")
    op.drop_constraint(op.f("uq_group__personal_of"), "group_", type_="unique")
    op.drop_column("group_", "max_active_runs")
    op.drop_column("group_", "max_bytes")
    op.drop_column("group_", "personal_of")
    op.drop_index(op.f("ix_share_link_run_id"), table_name="share_link")
    op.drop_table("share_link")
    op.drop_index(op.f("ix_invitation_group_id"), table_name="invitation")
    op.drop_table("invitation")
    op.drop_table("sign_in_link")
    op.drop_index(op.f("ix_browser_session_person_id"), table_name="browser_session")
    op.drop_table("browser_session")
    op.drop_index(op.f("ix_api_token_person_id"), table_name="api_token")
    op.drop_table("api_token")
    op.drop_index(op.f("ix_audit_entry_person_id_audit_entry_id"), table_name="audit_entry")
    op.drop_index(op.f("ix_audit_entry_action_audit_entry_id"), table_name="audit_entry")
    op.drop_table("audit_entry")
