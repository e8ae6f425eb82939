"""The database itself refuses to change or delete a stored version."""

from alembic import op

revision = "0002"
down_revision = "0001"

MESSAGE = "a stored recipe version is final, save a new one"


def upgrade() -> None:
    """Add the triggers."""
    if op.get_bind().dialect.name == "sqlite":
        for action in ("UPDATE", "DELETE"):
            op.execute(
                f"CREATE TRIGGER recipe_version_no_{action.lower()} BEFORE {action} ON recipe_version "
                f"BEGIN SELECT RAISE(ABORT, '{MESSAGE}'); END"
            )
    else:
        op.execute(
            "CREATE FUNCTION recipe_version_final() RETURNS trigger LANGUAGE plpgsql AS "
            f"$$ BEGIN RAISE EXCEPTION '{MESSAGE}'; END $$"
        )
        op.execute(
            "CREATE TRIGGER recipe_version_final BEFORE UPDATE OR DELETE OR TRUNCATE ON recipe_version "
            "FOR EACH STATEMENT EXECUTE FUNCTION recipe_version_final()"
        )


def downgrade() -> None:
    """Drop the triggers."""
    if op.get_bind().dialect.name == "sqlite":
        for action in ("update", "delete"):
            op.execute(f"DROP TRIGGER recipe_version_no_{action}")
    else:
        op.execute("DROP TRIGGER recipe_version_final ON recipe_version")
        op.execute("DROP FUNCTION recipe_version_final()")
