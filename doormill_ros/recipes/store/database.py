"""The recipe database: versions that are never overwritten, found by door and by bar code."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, cast

import sqlalchemy as sa

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.errors import (
    BadText,
    DatabaseError,
    UnknownBarCode,
    UnknownDoor,
    UnknownVersion,
)
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.connection import StoreConnection
from doormill_ros.recipes.store.statements import (
    BY_BAR_CODE,
    BY_DOOR,
    BY_VERSION,
    LOCK_DOOR,
    RECORD,
    first_version,
    next_version,
    storable,
)
from doormill_ros.recipes.store.tool_table import ToolTable
from doormill_ros.recipes.stored import content_of, recipe_of, rules, seal
from doormill_ros.recipes.tabled_tool import completed

SHIPPER = "doormill_ros"  #: author of the recipes that ship


@dataclass(frozen=True)
class RecipeRecord:
    """One stored version without its content."""

    door_id: str
    version: int
    bar_code: str
    author: str
    created: datetime


@dataclass(frozen=True)
class ImportReport:
    """What an import did.

    Attributes:
        saved: Versions that were made.
        unchanged: Door ids whose newest version already says the same.
    """

    saved: tuple[RecipeRecord, ...]
    unchanged: tuple[str, ...]


class RecipeDatabase:
    """Recipes of one factory; several cells may share it.

    Attributes:
        url: Where it is, without its password.
        tools: The table of tools that recipes name.
    """

    def __init__(self, url: str | None = None, clock: Callable[[], datetime] | None = None) -> None:
        """Open the database, make it when it is not there, migrate it when it is old.

        Args:
            url: See `make_engine`.
            clock: Gives the time of a save with its offset from UTC; None for the system's clock.

        Raises:
            DatabaseUnreachable: Nothing answers, or it is not a database of recipes.
            SchemaTooNew: A later release has written it.
        """
        self._clock = clock or (lambda: datetime.now(UTC))
        self._store = StoreConnection(url)
        self.url = self._store.url
        self.tools = ToolTable(self._store, self._clock)

    def __enter__(self) -> RecipeDatabase:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close every connection."""
        self._store.close()

    def get(self, door_id: str, version: int | None = None) -> Recipe:
        """The recipe of a door, the newest version unless one is given.

        Raises:
            UnknownDoor: No such door.
            UnknownVersion: The door has no such version.
            DamagedRecord: The stored text is not what was stored.
        """
        if not storable(door_id):
            raise _unknown_door(door_id)
        if version is None:
            rows = self._store.read(BY_DOOR, {"door_id": door_id})
            if not rows:
                raise _unknown_door(door_id)
        else:
            wanted = version if 0 < version < 2**31 else 0  # the column holds no others
            rows = self._store.read(BY_VERSION, {"door_id": door_id, "wanted": wanted})
            if not rows:
                versions = [record.version for record in self.history(door_id)]
                raise UnknownVersion(
                    f"found version {version} for door {door_id!r}, allowed are {versions[0]} to "
                    f"{versions[-1]}",
                    found=version,
                )
        return recipe_of(rows[0], self.tools.look_up)

    def find_bar_code(self, code: str) -> Recipe:
        """The newest recipe of the door with this bar code.

        Raises:
            UnknownBarCode: No door has it now.
            DamagedRecord: The stored text is not what was stored.
        """
        rows = self._store.read(BY_BAR_CODE, {"bar_code": code}) if storable(code) else ()
        if not rows:
            raise UnknownBarCode(
                f"found no recipe for bar code {code!r}; import one, or read the code again", found=code
            )
        return recipe_of(rows[0], self.tools.look_up)

    def list(self, prefix: str = "", limit: int | None = None) -> tuple[RecipeRecord, ...]:
        """The newest version of every door, sorted by door id.

        Args:
            prefix: Only doors whose id starts so.
            limit: At most so many.
        """
        newest = sa.and_(
            schema.door.c.door_id == schema.recipe_version.c.door_id,
            schema.door.c.latest_version == schema.recipe_version.c.version,
        )
        query = sa.select(*RECORD).select_from(schema.recipe_version.join(schema.door, newest))
        query = query.where(schema.door.c.door_id.startswith(prefix, autoescape=True))
        query = query.order_by(schema.recipe_version.c.door_id).limit(limit)
        rows = self._store.read(query)
        return tuple(sorted((_record(row) for row in rows), key=lambda record: record.door_id))

    def history(self, door_id: str) -> tuple[RecipeRecord, ...]:
        """Every version of a door, oldest first; raises UnknownDoor."""
        if not storable(door_id):
            raise _unknown_door(door_id)
        query = sa.select(*RECORD).where(schema.recipe_version.c.door_id == door_id)
        rows = self._store.read(query.order_by(schema.recipe_version.c.version))
        if not rows:
            raise _unknown_door(door_id)
        return tuple(_record(row) for row in rows)

    def save(self, recipe: Recipe, author: str) -> Recipe:
        """Store a recipe as a new version.

        Args:
            recipe: What to store; its version, author and time are replaced.
            author: Who saves it, 1 to 100 printable characters.

        Returns:
            The recipe with its version, author and time.

        Raises:
            FieldError: The recipe or the author is wrong; nothing is stored.
            BarCodeTaken: Another door has the bar code.
        """
        return self.save_all([recipe], author)[0]

    def save_all(self, recipes: Iterable[Recipe], author: str) -> tuple[Recipe, ...]:
        """Store several recipes in one transaction: all of them, or none. See `save`."""
        checked = [self._checked(recipe, author) for recipe in recipes]
        with self._store.write() as connection:
            # In one order everywhere, so that two savers cannot wait for each other.
            saved = {}
            for index in sorted(range(len(checked)), key=lambda index: checked[index].door_id):
                version = next_version(connection, checked[index])
                saved[index] = self._save(connection, checked[index], author, version)
            return tuple(saved[index] for index in range(len(checked)))

    def import_file(self, path: str | Path, author: str) -> ImportReport:
        """Store the recipes of a file that differ from the newest version: all, or none.

        Args:
            path: .xlsx, .csv, .txt (the thesis' table), .yaml or .json file.
            author: Who imports it.

        Raises:
            ExchangeError: The file cannot be read.
            FieldError: A recipe or the author is wrong.
            BarCodeTaken: Another door has a bar code.
        """
        checked = [self._checked(recipe, author) for recipe in read_file(path, self.tools.look_up)]
        saved, unchanged = [], []
        with self._store.write() as connection:
            for recipe in sorted(checked, key=lambda recipe: recipe.door_id):
                row = connection.execute(BY_DOOR, {"door_id": recipe.door_id}).one_or_none()
                if row is not None and row.document == content_of(recipe):
                    unchanged.append(recipe.door_id)
                else:
                    version = next_version(connection, recipe)
                    saved.append(_record_of(self._save(connection, recipe, author, version)))
        return ImportReport(tuple(saved), tuple(unchanged))

    def export_file(self, path: str | Path, door_ids: Sequence[str] | None = None) -> tuple[Recipe, ...]:
        """Write the newest recipes of some or of all doors; `path`'s ending chooses the format.

        Raises:
            UnknownDoor: No such door.
            ExchangeError: The format has no place for something, or the file cannot be written.
        """
        chosen = [record.door_id for record in self.list()] if door_ids is None else door_ids
        recipes = tuple(self.get(door_id) for door_id in chosen)
        write_file(path, recipes)
        return recipes

    def add_shipped(self, author: str = SHIPPER) -> tuple[RecipeRecord, ...]:
        """Store the recipes that ship with the package and that the database does not know.

        A door that an earlier release has put there and nobody has saved since gets this release's
        recipe as a new version.
        """
        wanted = []
        for recipe in shipped_recipes().values():
            rows = self._store.read(BY_DOOR, {"door_id": recipe.door_id})
            if not rows or self._is_earlier(rows[0], recipe, author):
                wanted.append(recipe)
        if not wanted:
            return ()
        checked = [self._checked(recipe, author) for recipe in wanted]
        saved = []
        with self._store.write() as connection:
            for recipe in sorted(checked, key=lambda recipe: recipe.door_id):
                # Another cell may be at the same: the first one is waited for.
                connection.execute(LOCK_DOOR, {"door_id": recipe.door_id})
                row = connection.execute(BY_DOOR, {"door_id": recipe.door_id}).one_or_none()
                version = None
                if row is None:
                    version = first_version(connection, recipe)
                elif self._is_earlier(row, recipe, author):
                    version = next_version(connection, recipe)
                if version is not None:
                    saved.append(_record_of(self._save(connection, recipe, author, version)))
        return tuple(saved)

    @staticmethod
    def _is_earlier(row: sa.Row[Any], recipe: Recipe, author: str) -> bool:
        """True when an earlier release has stored another recipe, and nobody else one since."""
        return bool(row.author == author and row.document != content_of(recipe))

    def _checked(self, recipe: Recipe, author: str) -> Recipe:
        if not author.strip():
            raise BadText("author", f"found {author!r}, allowed are 1 to 100 printable characters")
        document = completed(recipe.to_document(), self.tools.look_up)
        return Recipe.from_document({**document, "author": author})

    def _save(self, connection: sa.Connection, recipe: Recipe, author: str, version: int) -> Recipe:
        """Store a checked recipe under a version drawn for it."""
        created = self._clock().astimezone(UTC)
        stored = recipe.stamped(version, author, created)
        content = content_of(stored)
        connection.execute(
            schema.recipe_version.insert().values(
                door_id=stored.door_id,
                version=version,
                bar_code=stored.bar_code,
                author=author,
                created=created.isoformat(),
                document=content,
                sha256=seal(content, rules()),
                rules=rules(),
            )
        )
        return stored


def _record(row: sa.Row[Any]) -> RecipeRecord:
    created = datetime.fromisoformat(row.created)
    return RecipeRecord(row.door_id, row.version, row.bar_code, row.author, created)


def _record_of(recipe: Recipe) -> RecipeRecord:
    created = cast(datetime, recipe.created)  # a recipe that was stored has one
    return RecipeRecord(recipe.door_id, recipe.version, recipe.bar_code, recipe.author, created)


def _unknown_door(door_id: str) -> DatabaseError:
    return UnknownDoor(f"found no recipe for door {door_id!r}; import one, or correct the id", found=door_id)
