"""Note by which rules a version was checked before it was stored."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add the column; nobody knows the rules of what is stored already."""
    op.add_column(
        "recipe_version", sa.Column("rules", sa.String(16), nullable=False, server_default=sa.text("''"))
    )


def downgrade() -> None:
    """Drop the column; the seals of what was stored with it no longer hold."""
    op.drop_column("recipe_version", "rules")
