"""Doors, found by id and by bar code, and the versions of their recipes."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create both tables."""
    op.create_table(
        "door",
        sa.Column("door_id", sa.String(64), primary_key=True),
        sa.Column("bar_code", sa.String(64), nullable=False),
        sa.Column("latest_version", sa.Integer, nullable=False),
        sa.UniqueConstraint("bar_code", name="door_bar_code_key"),
    )
    op.create_table(
        "recipe_version",
        sa.Column("door_id", sa.String(64), sa.ForeignKey("door.door_id"), primary_key=True),
        sa.Column("version", sa.Integer, primary_key=True),
        sa.Column("bar_code", sa.String(64), nullable=False),
        sa.Column("author", sa.String(100), nullable=False),
        sa.Column("created", sa.String(32), nullable=False),
        sa.Column("document", sa.Text, nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
    )


def downgrade() -> None:
    """Drop both tables."""
    op.drop_table("recipe_version")
    op.drop_table("door")
