"""The table of tools, and what each run cuts with them."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Create both tables."""
    op.create_table(
        "tool",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("document", sa.Text, nullable=False),
        sa.Column("cut", sa.Double, nullable=False),
        sa.Column("broken", sa.Boolean, nullable=False),
        sa.Column("author", sa.String(100), nullable=False),
        sa.Column("changed", sa.String(32), nullable=False),
    )
    op.create_table(
        "tool_use",
        sa.Column("run_id", sa.String(64), primary_key=True),
        sa.Column("tool", sa.String(64), primary_key=True),
        sa.Column("metres", sa.Double, nullable=False),
        sa.Column("counted", sa.Boolean, nullable=False),
    )


def downgrade() -> None:
    """Drop both tables."""
    op.drop_table("tool_use")
    op.drop_table("tool")
