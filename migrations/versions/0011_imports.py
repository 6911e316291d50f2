"""Frames that are imported from a folder of the server or a prefix of S3."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0011"
down_revision: str | None = "0010"
branch_labels: str | Sequence[str] | None = None
depends_on: str | Sequence[str] | None = None


def upgrade() -> None:
    op.alter_column("file", "store_key", type_=sa.String(length=1200), existing_nullable=False)
    op.add_column("file", sa.Column("version", sa.String(length=100), nullable=True))
    op.create_table(
        "import_",
        sa.Column("experiment_id", sa.Uuid(), nullable=False),
        sa.Column("root", sa.String(length=50), nullable=False),
        sa.Column("path", sa.String(length=1000), nullable=False),
        sa.Column(
            "mode",
            sa.Enum("copy", "reference", name="known_state", native_enum=False, create_constraint=True, length=20),
            nullable=False,
        ),
        sa.Column("n_files", sa.Integer(), nullable=False),
        sa.Column("size_bytes", sa.BigInteger(), nullable=False),
        sa.Column("done_bytes", sa.BigInteger(), nullable=False),
        sa.Column("bytes_per_s", sa.Float(), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), server_default=sa.text("now()"), nullable=False),
        sa.ForeignKeyConstraint(
            ["experiment_id"], ["experiment.id"], name=op.f("fk_import__experiment_id_experiment"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("experiment_id", name=op.f("pk_import_")),
    )


def downgrade() -> None:
    op.drop_table("import_")
    op.execute("DELETE FROM file WHERE version IS NOT NULL")
    op.drop_column("file", "version")
    op.alter_column("file", "store_key", type_=sa.String(length=300), existing_nullable=False)
