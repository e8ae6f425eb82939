"""Tables of the catalogue; their names let them stand in one database with the recipes."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import sqlalchemy as sa

from doormill_ros.catalogue.errors import CatalogueTooNewError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun

VERSION = 1
LOCK = 0x72756E73  #: key of PostgreSQL's advisory lock: one writer at a time, for the milliseconds of a bag's rows

metadata = sa.MetaData()
_TYPES: dict[str, sa.types.TypeEngine[Any]] = {
    "str": sa.Text(),
    "int": sa.BigInteger(),
    "float": sa.Double(),
    "bool": sa.Boolean(),
}


def _columns(kind: type, *keys: str) -> list[sa.Column[object]]:
    """A column for each field of a dataclass; types are told by name, as the annotations are."""
    found: list[sa.Column[object]] = []
    for field in fields(kind):
        name, _, optional = str(field.type).partition(" | ")
        found.append(
            sa.Column(field.name, _TYPES[name], primary_key=field.name in keys, nullable=bool(optional))
        )
    return found


version = sa.Table("catalogue_version", metadata, sa.Column("version", sa.Integer, primary_key=True))
run = sa.Table("catalogue_run", metadata, *_columns(CataloguedRun, "run_id"))
inspection = sa.Table(
    "catalogue_inspection", metadata, *_columns(CataloguedInspection, "run_id", "inspection")
)
kept = sa.Table(
    "catalogue_kept",
    metadata,
    sa.Column("run_id", sa.Text, primary_key=True),
    sa.Column("reason", sa.Text, nullable=False),
)
sa.Index("catalogue_run_bag", run.c.bag)
sa.Index("catalogue_run_door", run.c.door_id)


def found_version(connection: sa.Connection) -> int | None:
    """Version of the tables that are there, None for none.

    Raises:
        CatalogueTooNewError: Another release made them.
    """
    if not sa.inspect(connection).has_table(version.name):
        return None
    found = connection.execute(sa.select(sa.func.max(version.c.version))).scalar()
    if found is not None and found != VERSION:
        raise CatalogueTooNewError(
            f"the catalogue has version {found}, allowed is {VERSION}; update this installation, or name another "
            "database and fill it with catalogue rebuild DIR",
            found=found,
        )
    return found


def make_tables(connection: sa.Connection) -> None:
    """Make what is missing, inside the caller's transaction."""
    lock(connection)
    if found_version(connection) is None:
        metadata.create_all(connection)
        connection.execute(version.insert().values(version=VERSION))


def lock(connection: sa.Connection) -> None:
    """Let no other writer in until the transaction ends; on SQLite its begin does so."""
    if connection.dialect.name == "postgresql":
        connection.execute(sa.text("SELECT pg_advisory_xact_lock(:key)"), {"key": LOCK})
