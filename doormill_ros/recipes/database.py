"""The recipe database: versions that are never overwritten, found by door and by bar code."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import sqlalchemy as sa

from doormill_ros.recipes import schema
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.engine import WRITE, make_engine
from doormill_ros.recipes.errors import (
    BadText,
    DamagedRecord,
    DatabaseUnreachable,
    UnknownBarCode,
    UnknownDoor,
    UnknownVersion,
)
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.statements import BY_BAR_CODE, BY_DOOR, BY_VERSION, RECORD, next_version

STAMP = ("version", "author", "created")  #: columns of their own, not part of the stored document


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
    """Recipes of one factory; several cells may share it."""

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
        self._engine = make_engine(url)
        self.url = self._engine.url.render_as_string(hide_password=True)
        try:
            with self._begin() as connection:
                current = schema.current_revision(connection)
            if current != schema.REVISIONS[-1]:
                with self._begin(write=True) as connection:
                    schema.migrate(connection)
        except BaseException:
            self._engine.dispose()
            raise

    def __enter__(self) -> RecipeDatabase:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close every connection."""
        self._engine.dispose()

    def get(self, door_id: str, version: int | None = None) -> Recipe:
        """The recipe of a door, the newest version unless one is given.

        Raises:
            UnknownDoor: No such door.
            UnknownVersion: The door has no such version.
            DamagedRecord: The stored text is not what was stored.
        """
        if not _storable(door_id):
            raise _unknown_door(door_id)
        with self._begin() as connection:
            if version is None:
                row = connection.execute(BY_DOOR, {"door_id": door_id}).one_or_none()
            else:
                wanted = version if 0 < version < 2**31 else 0  # the column holds no others
                row = connection.execute(BY_VERSION, {"door_id": door_id, "wanted": wanted}).one_or_none()
                if row is None:
                    versions = [record.version for record in self._history(connection, door_id)]
                    raise UnknownVersion(
                        f"found version {version} for door {door_id!r}, allowed are {versions[0]} to "
                        f"{versions[-1]}",
                        found=version,
                    )
        if row is None:
            raise _unknown_door(door_id)
        return _recipe(row)

    def find_bar_code(self, code: str) -> Recipe:
        """The newest recipe of the door with this bar code.

        Raises:
            UnknownBarCode: No door has it now.
            DamagedRecord: The stored text is not what was stored.
        """
        row = None
        if _storable(code):
            with self._begin() as connection:
                row = connection.execute(BY_BAR_CODE, {"bar_code": code}).one_or_none()
        if row is None:
            raise UnknownBarCode(
                f"found no recipe for bar code {code!r}; import one, or read the code again", found=code
            )
        return _recipe(row)

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
        with self._begin() as connection:
            rows = connection.execute(query).all()
        return tuple(sorted((_record(row) for row in rows), key=lambda record: record.door_id))

    def history(self, door_id: str) -> tuple[RecipeRecord, ...]:
        """Every version of a door, oldest first; raises UnknownDoor."""
        if not _storable(door_id):
            raise _unknown_door(door_id)
        with self._begin() as connection:
            return self._history(connection, door_id)

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
        with self._begin(write=True) as connection:
            # In one order everywhere, so that two savers cannot wait for each other.
            saved = {}
            for index in sorted(range(len(checked)), key=lambda index: checked[index].door_id):
                saved[index] = self._save(connection, checked[index], author)
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
        checked = [self._checked(recipe, author) for recipe in read_file(path)]
        saved, unchanged = [], []
        with self._begin(write=True) as connection:
            for recipe in sorted(checked, key=lambda recipe: recipe.door_id):
                row = connection.execute(BY_DOOR, {"door_id": recipe.door_id}).one_or_none()
                if row is not None and row.document == _content(recipe):
                    unchanged.append(recipe.door_id)
                else:
                    saved.append(_record_of(self._save(connection, recipe, author)))
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

    def add_shipped(self, author: str = "doormill_ros") -> tuple[RecipeRecord, ...]:
        """Store the recipes that ship with the package and that the database does not know."""
        shipped = shipped_recipes()
        known = {record.door_id for record in self.list()}
        checked = [self._checked(recipe, author) for name, recipe in shipped.items() if name not in known]
        if not checked:
            return ()
        with self._begin(write=True) as connection:
            saved = [self._save(connection, recipe, author, only_new=True) for recipe in checked]
        return tuple(_record_of(recipe) for recipe in saved if recipe is not None)

    @contextmanager
    def _begin(self, write: bool = False) -> Iterator[sa.Connection]:
        """A transaction; a failure of the database itself becomes DatabaseUnreachable."""
        try:
            with self._engine.connect() as connection:
                connection.execution_options(**{WRITE: write})
                if not write and connection.dialect.name == "postgresql":
                    # A look-up is one statement: leave out the two journeys for BEGIN and COMMIT.
                    connection.execution_options(isolation_level="AUTOCOMMIT")
                with connection.begin():
                    yield connection
        except (sa.exc.OperationalError, sa.exc.InterfaceError, sa.exc.DatabaseError) as error:
            if isinstance(error, sa.exc.IntegrityError):
                raise
            reason = " ".join(str(error.orig).split())
            raise DatabaseUnreachable(f"the recipe database {self.url} cannot be used: {reason}") from error

    def _checked(self, recipe: Recipe, author: str) -> Recipe:
        if not author.strip():
            raise BadText("author", f"found {author!r}, allowed are 1 to 100 printable characters")
        return Recipe.from_document({**recipe.to_document(), "author": author})

    def _save(
        self, connection: sa.Connection, recipe: Recipe, author: str, only_new: bool = False
    ) -> Recipe | None:
        """Store a checked recipe; with `only_new` None when the door or its bar code is known."""
        version = next_version(connection, recipe, only_new)
        if version is None:
            return None
        stored = recipe.stamped(version, author, self._clock().astimezone(UTC))
        content = _content(stored)
        connection.execute(
            schema.recipe_version.insert().values(
                door_id=stored.door_id,
                version=version,
                bar_code=stored.bar_code,
                author=author,
                created=stored.created.isoformat(),
                document=content,
                sha256=_sha256(content),
            )
        )
        return stored

    def _history(self, connection: sa.Connection, door_id: str) -> tuple[RecipeRecord, ...]:
        query = sa.select(*RECORD).where(schema.recipe_version.c.door_id == door_id)
        rows = connection.execute(query.order_by(schema.recipe_version.c.version)).all()
        if not rows:
            raise _unknown_door(door_id)
        return tuple(_record(row) for row in rows)


def _content(recipe: Recipe) -> str:
    document = {key: value for key, value in recipe.to_document().items() if key not in STAMP}
    return json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _storable(text: str) -> bool:
    """True for a text that a database takes as an argument; every stored id and code is one."""
    return text.isascii() and "\x00" not in text


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _recipe(row: sa.Row) -> Recipe:
    if _sha256(row.document) != row.sha256:
        raise DamagedRecord(
            f"version {row.version} of door {row.door_id!r} is not what was stored; restore a backup",
            found=row.sha256,
        )
    document = json.loads(row.document)
    return Recipe.from_document({**document, **{name: getattr(row, name) for name in STAMP}})


def _record(row: sa.Row) -> RecipeRecord:
    created = datetime.fromisoformat(row.created)
    return RecipeRecord(row.door_id, row.version, row.bar_code, row.author, created)


def _record_of(recipe: Recipe) -> RecipeRecord:
    return RecipeRecord(recipe.door_id, recipe.version, recipe.bar_code, recipe.author, recipe.created)


def _unknown_door(door_id: str) -> UnknownDoor:
    return UnknownDoor(f"found no recipe for door {door_id!r}; import one, or correct the id", found=door_id)
