"""Tables of the recipe database, and bringing an older database up to them.

`door` holds the newest version number and bar code of each door; `recipe_version` holds every
version as the JSON text of its document, with who and when, a seal, and the rules by which it was
checked. Rows of `recipe_version` are final: triggers refuse to change or delete them. `tool` holds the
tools that recipes name, each with what it has cut; `tool_use` what each run cuts with which, and whether
that is in the sum already.
"""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa

from doormill_ros.recipes.errors import SchemaTooNew

REVISIONS = ("0001", "0002", "0003", "0004")  #: of the migrations, oldest first
MIGRATIONS = Path(__file__).parent / "migrations"
LOCK = 0x646F6F72  #: key of PostgreSQL's advisory lock during a migration

metadata = sa.MetaData()

door = sa.Table(
    "door",
    metadata,
    sa.Column("door_id", sa.String(64), primary_key=True),
    sa.Column("bar_code", sa.String(64), nullable=False),
    sa.Column("latest_version", sa.Integer, nullable=False),
    sa.UniqueConstraint("bar_code", name="door_bar_code_key"),
)

recipe_version = sa.Table(
    "recipe_version",
    metadata,
    sa.Column("door_id", sa.String(64), sa.ForeignKey("door.door_id"), primary_key=True),
    sa.Column("version", sa.Integer, primary_key=True),
    sa.Column("bar_code", sa.String(64), nullable=False),
    sa.Column("author", sa.String(100), nullable=False),
    sa.Column("created", sa.String(32), nullable=False),
    sa.Column("document", sa.Text, nullable=False),
    sa.Column("sha256", sa.String(64), nullable=False),
    sa.Column("rules", sa.String(16), nullable=False, server_default=sa.text("''")),
)

tool = sa.Table(
    "tool",
    metadata,
    sa.Column("name", sa.String(64), primary_key=True),
    sa.Column("document", sa.Text, nullable=False),
    sa.Column("cut", sa.Double, nullable=False),
    sa.Column("broken", sa.Boolean, nullable=False),
    sa.Column("author", sa.String(100), nullable=False),
    sa.Column("changed", sa.String(32), nullable=False),
)

tool_use = sa.Table(
    "tool_use",
    metadata,
    sa.Column("run_id", sa.String(64), primary_key=True),
    sa.Column("tool", sa.String(64), primary_key=True),
    sa.Column("metres", sa.Double, nullable=False),
    sa.Column("counted", sa.Boolean, nullable=False),
)


def current_revision(connection: sa.Connection) -> str | None:
    """Revision of the database, None for an empty one."""
    if not sa.inspect(connection).has_table("alembic_version"):
        return None
    return connection.execute(sa.text("SELECT version_num FROM alembic_version")).scalar()


def migrate(connection: sa.Connection, target: str = REVISIONS[-1]) -> None:
    """Bring the database to a revision, inside the caller's transaction.

    Several cells may open one database at once: the first migrates, the others wait. On SQLite
    the transaction itself (BEGIN IMMEDIATE) is that lock.

    Raises:
        SchemaTooNew: A later release has migrated it already.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(sa.text("SELECT pg_advisory_xact_lock(:key)"), {"key": LOCK})
    revision = current_revision(connection)
    if revision is not None and revision not in REVISIONS:
        raise SchemaTooNew(
            f"the recipe database has schema {revision!r}, allowed is up to {REVISIONS[-1]!r}; "
            "update this installation",
            found=revision,
        )
    if revision == target:
        return
    # Alembic takes longer to import than everything else here, and is needed once a release.
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    command.upgrade(config, target)
