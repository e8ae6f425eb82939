"""SQL of the recipe database, built once: what is looked up, and how a version number is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sqlalchemy as sa

from doormill_ros.recipes.errors import BarCodeTaken, DatabaseError
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store import schema

if TYPE_CHECKING:
    from sqlalchemy.dialects import postgresql, sqlite

RECORD = [schema.recipe_version.c[name] for name in ("door_id", "version", "bar_code", "author", "created")]
_ROW = sa.select(*RECORD, *(schema.recipe_version.c[name] for name in ("document", "sha256", "rules")))
_NEWEST = _ROW.join_from(
    schema.door,
    schema.recipe_version,
    sa.and_(
        schema.door.c.door_id == schema.recipe_version.c.door_id,
        schema.door.c.latest_version == schema.recipe_version.c.version,
    ),
)
BY_DOOR = _NEWEST.where(schema.door.c.door_id == sa.bindparam("door_id"))
BY_BAR_CODE = _NEWEST.where(schema.door.c.bar_code == sa.bindparam("bar_code"))
BY_VERSION = _ROW.where(
    schema.recipe_version.c.door_id == sa.bindparam("door_id"),
    schema.recipe_version.c.version == sa.bindparam("wanted"),
)

#: Holds others back that save the same door, to the end of the transaction; SQLite does so anyway.
LOCK_DOOR = sa.select(schema.door.c.door_id).where(schema.door.c.door_id == sa.bindparam("door_id"))
LOCK_DOOR = LOCK_DOOR.with_for_update()


def next_version(connection: sa.Connection, recipe: Recipe) -> int:
    """Count the door's version up, so that no two savers can get the same one.

    The order matters on PostgreSQL, where others save at the same time: `ON CONFLICT (door_id) DO
    UPDATE` would meet the bar code of the same door, just made by another saver, as a violation.

    Args:
        connection: In a transaction that is going to write.
        recipe: What shall be stored.

    Raises:
        BarCodeTaken: Another door has the bar code.
    """
    version = _count_up(connection, recipe) or first_version(connection, recipe)
    # None: somebody was quicker, with this door, which is there now, or with the bar code.
    version = version or _count_up(connection, recipe)
    if version is None:
        raise _bar_code_taken(recipe)
    return version


def first_version(connection: sa.Connection, recipe: Recipe) -> int | None:
    """Make a door; its version is 1, or None when the door or its bar code is known."""
    insert = insert_into(connection, schema.door).values(
        door_id=recipe.door_id, bar_code=recipe.bar_code, latest_version=1
    )
    statement = insert.on_conflict_do_nothing().returning(schema.door.c.latest_version)
    return connection.execute(statement).scalar()


def insert_into(connection: sa.Connection, table: sa.Table) -> postgresql.Insert | sqlite.Insert:
    """An insertion into a table that can say what to do with a row that is there already."""
    # Here, as the other one takes a tenth of the database's start; the one in use is there.
    if connection.dialect.name == "postgresql":
        from sqlalchemy.dialects import postgresql

        return postgresql.insert(table)
    from sqlalchemy.dialects import sqlite

    return sqlite.insert(table)


_COUNT_UP = (
    schema.door.update()
    .where(schema.door.c.door_id == sa.bindparam("door"))
    .values(latest_version=schema.door.c.latest_version + 1, bar_code=sa.bindparam("code"))
    .returning(schema.door.c.latest_version)
)


def _count_up(connection: sa.Connection, recipe: Recipe) -> int | None:
    try:
        return connection.execute(_COUNT_UP, {"door": recipe.door_id, "code": recipe.bar_code}).scalar()
    except sa.exc.IntegrityError as error:
        raise _bar_code_taken(recipe) from error


def _bar_code_taken(recipe: Recipe) -> DatabaseError:
    return BarCodeTaken(
        f"found bar code {recipe.bar_code!r} for door {recipe.door_id!r}, which another door has; "
        "give every door its own",
        found=recipe.bar_code,
    )


def storable(text: str) -> bool:
    """True for a text that a database takes as an argument; every stored id, code and tool's name is one."""
    return text.isascii() and "\x00" not in text
