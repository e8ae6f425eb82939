"""The catalogue itself: rows of runs in SQLite or PostgreSQL, by the engine of the recipe database."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from doormill_ros.catalogue import schema
from doormill_ros.catalogue.errors import CatalogueUnreachableError, UnknownRunError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun, CatalogueRow
from doormill_ros.recipes.store.engine import default_url
from doormill_ros.recipes.store.statements import insert_into
from doormill_ros.recipes.store.transactions import Transactions
from doormill_ros.recording.bag_folders import content_of_bag

ENVIRONMENT, FILE = "DOORMILL_CATALOGUE", "catalogue.sqlite"
PAGE = 2000  # rows that are read at a time
_RUN = [field.name for field in fields(CataloguedRun)]
_PLACE = ("bag", "bag_sha256", "bag_bytes")


@dataclass(frozen=True)
class Selection:
    """Which runs; what is None or empty does not narrow.

    Attributes:
        door_id: Of this door.
        run_id: This one.
        bag: Of the bag in this folder.
        since_ns, until_ns: Begun from then on, and before then [ns since the epoch].
        failed: True for those that did not end well or did not end.
    """

    door_id: str = ""
    run_id: str = ""
    since_ns: int | None = None
    until_ns: int | None = None
    failed: bool = False
    bag: str = ""

    def conditions(self) -> list[sa.ColumnElement[bool]]:
        """The same as conditions on `catalogue_run`."""
        columns = schema.run.c
        found: list[sa.ColumnElement[bool]] = []
        if self.door_id:
            found.append(columns.door_id == self.door_id)
        if self.run_id:
            found.append(columns.run_id == self.run_id)
        if self.bag:
            found.append(columns.bag == self.bag)
        if self.since_ns is not None:
            found.append(columns.begun_ns >= self.since_ns)
        if self.until_ns is not None:
            found.append(columns.begun_ns < self.until_ns)
        if self.failed:
            found.append(sa.or_(columns.success.is_(None), columns.success.is_(sa.false())))
        return found


class Catalogue(Transactions):
    """Runs of one or several cells; a context manager."""

    def __init__(self, url: str | None = None) -> None:
        """Open it, make it when it is not there.

        Args:
            url: As for the recipe database; None or empty for $DOORMILL_CATALOGUE, else a SQLite file in the user's
                data folder.

        Raises:
            CatalogueUnreachableError: Nothing answers, or it is no database.
            CatalogueTooNewError: Another release made it.
            DatabaseUnreachable: Not a URL, or of another kind of database.
        """
        super().__init__(url or default_url(ENVIRONMENT, FILE))
        try:
            with self._failures(), self._engine.connect() as connection:
                found = schema.found_version(connection)
            if found is None:
                with self.write() as connection:
                    schema.make_tables(connection)
        except BaseException:
            self.close()
            raise

    def store(
        self, bag: str, runs: Sequence[CataloguedRun], inspections: Iterable[CataloguedInspection] = ()
    ) -> None:
        """Put the runs of a bag and inspections in place of what was known of them: all of it, or nothing.

        Other runs of the cell that were in a bag of this place have lost it. A run whose other bag is still there as it
        is known stays with that one, unless the run ended in this bag alone; no run that ended becomes one that did
        not.

        Args:
            bag: The bag's folder as it stands in the runs.
            runs: All that the bag holds so far.
            inspections: Found beside it.
        """
        elsewhere = self._elsewhere(runs)
        with self.write() as connection:
            schema.lock(connection)
            ids, cells = [run.run_id for run in runs], {run.cell for run in runs}
            if bag:
                # Another machine may have a bag of the same path.
                lost = (
                    (schema.run.c.bag == bag) & schema.run.c.run_id.not_in(ids) & schema.run.c.cell.in_(cells)
                )
                connection.execute(schema.run.update().where(lost).values(bag="", bag_sha256="", bag_bytes=0))
            _put_runs(connection, runs, elsewhere)
            for one in sorted(inspections, key=lambda one: (one.run_id, one.inspection)):
                # An inspection is of one run: of another it was before somebody put it right.
                own = sa.select(schema.run.c.cell).where(schema.run.c.run_id == one.run_id)
                columns = schema.inspection.c
                others = (columns.inspection == one.inspection) & (columns.run_id != one.run_id)
                connection.execute(schema.inspection.delete().where(others, _of_cells(own)))
                _put(connection, schema.inspection, asdict(one))

    def add(self, runs: Iterable[CataloguedRun]) -> None:
        """Put runs of a bag that is being recorded beside those that are known of it: all of them, or none."""
        with self.write() as connection:
            schema.lock(connection)
            _put_runs(connection, runs, {})

    def _elsewhere(self, runs: Sequence[CataloguedRun]) -> dict[str, str]:
        """The bag of each run that is known to lie elsewhere and still does; read from the disk before any lock."""
        columns, bags = schema.run.c, {run.run_id: run.bag for run in runs}
        query = sa.select(columns.run_id, columns.bag, columns.bag_sha256)
        query = query.where(columns.run_id.in_(bags), columns.bag_sha256 != "")
        with self._failures(), self._engine.connect() as connection:
            known = [row for row in connection.execute(query) if row.bag != bags[row.run_id]]
        there = {bag for bag, sha256 in {(row.bag, row.bag_sha256) for row in known} if _holds(bag, sha256)}
        return {row.run_id: row.bag for row in known if row.bag in there}

    def forget_bags(self, folder: str, there: Collection[str], cells: Collection[str]) -> None:
        """The bags below a folder are these: the runs of others have lost them.

        Args:
            folder: Absolute, as in the rows.
            there: Folders of bags.
            cells: Another machine may have a folder of the same path: runs of other cells keep theirs.
        """
        columns = schema.run.c
        with self.write() as connection:
            schema.lock(connection)
            for gone in _below(connection, columns.bag, folder) - set(there):
                lost = schema.run.update().where(columns.bag == gone, columns.cell.in_(cells))
                connection.execute(lost.values(bag="", bag_sha256="", bag_bytes=0))

    def forget_inspections(self, folder: str, there: Collection[str], cells: Collection[str]) -> None:
        """The inspections below a folder are these: others of runs of the cells are gone.

        Args:
            folder: Absolute, as in the rows.
            there: Folders of inspections.
            cells: Another machine may have a folder of the same path: runs of other cells keep theirs.
        """
        columns = schema.inspection.c
        with self.write() as connection:
            schema.lock(connection)
            for gone in _below(connection, columns.inspection, folder) - set(there):
                found = columns.inspection == gone
                connection.execute(schema.inspection.delete().where(found, _of_cells(cells)))

    def cell_of(self, run_id: str) -> set[str]:
        """The cell of a run; none where the run is not known."""
        query = sa.select(schema.run.c.cell).where(schema.run.c.run_id == run_id)
        with self._failures(), self._engine.connect() as connection:
            return set(connection.execute(query).scalars())

    def inspections_below(self, folder: str) -> set[str]:
        """Folders of the known inspections below a folder, at any depth."""
        column = schema.inspection.c.inspection
        query = sa.select(column).where(column.startswith(f"{folder}/", autoescape=True))
        with self._failures(), self._engine.connect() as connection:
            return set(connection.execute(query).scalars())

    def replace_inspections(
        self, run_id: str, folder: str, inspections: Iterable[CataloguedInspection]
    ) -> None:
        """Put these inspections of a run in place of those that were known below a folder."""
        columns = schema.inspection.c
        with self.write() as connection:
            schema.lock(connection)
            within = columns.inspection.startswith(f"{folder}/", autoescape=True)
            connection.execute(schema.inspection.delete().where(columns.run_id == run_id, within))
            for one in inspections:
                _put(connection, schema.inspection, asdict(one))

    def keep(self, run_ids: Sequence[str], reason: str) -> None:
        """Keep the bags of runs for ever, or no longer so with an empty reason: of all of them, or of none.

        Raises:
            UnknownRunError: A run is not in the catalogue.
        """
        with self.write() as connection:
            schema.lock(connection)
            for run_id in run_ids:
                query = sa.select(schema.run.c.run_id).where(schema.run.c.run_id == run_id)
                if "\x00" in run_id or connection.execute(query).first() is None:
                    raise UnknownRunError(
                        f"found no run {run_id!r} in the catalogue {self.url}; catalogue list names them",
                        found=run_id,
                    )
                if reason:
                    _put(connection, schema.kept, {"run_id": run_id, "reason": reason})
                else:
                    connection.execute(schema.kept.delete().where(schema.kept.c.run_id == run_id))

    def forget_bag(self, bag: str, sha256: str) -> None:
        """The runs of a bag stay, the bag with this checksum is gone."""
        with self.write() as connection:
            schema.lock(connection)
            gone = schema.run.update().where(schema.run.c.bag == bag, schema.run.c.bag_sha256 == sha256)
            connection.execute(gone.values(bag="", bag_sha256="", bag_bytes=0))

    def rows(self, selection: Selection | None = None) -> Iterator[CatalogueRow]:
        """Runs in the order of their names, which begin with the time; read in pages."""
        columns, last = schema.run.c, ""
        conditions = (selection or Selection()).conditions()
        while True:
            page = sa.select(schema.run).where(columns.run_id > last, *conditions)
            page = page.order_by(columns.run_id).limit(PAGE)
            with self._failures(), self._engine.connect() as connection:
                found = connection.execute(page).mappings().all()
                if not found:
                    return
                ids = [row["run_id"] for row in found]
                last = ids[-1]
                inspected = _by_run(connection, schema.inspection, ids, schema.inspection.c.inspected_ns)
                kept = _by_run(connection, schema.kept, ids, schema.kept.c.reason)
            for row in found:
                run_id = row["run_id"]
                inspection = inspected.get(run_id)
                yield CatalogueRow(
                    CataloguedRun(**{name: row[name] for name in _RUN}),
                    None if inspection is None else CataloguedInspection(**inspection),
                    kept.get(run_id, {}).get("reason", ""),
                )

    def _told(self, error: sa.exc.InterfaceError | sa.exc.DatabaseError, reason: str) -> Exception:
        if "locked" in reason:
            return CatalogueUnreachableError(
                f"the catalogue {self.url} cannot be used: {reason}; ask again once the process that holds it is done"
            )
        return CatalogueUnreachableError(
            f"the catalogue {self.url} cannot be used: {reason}; where it is damaged, move it away and fill a new "
            "one with catalogue rebuild DIR"
        )


def _below(connection: sa.Connection, column: sa.Column[str], folder: str) -> set[str]:
    """What a column of paths names at a folder and below it."""
    within = sa.or_(column == folder, column.startswith(f"{folder}/", autoescape=True))
    return set(connection.execute(sa.select(column).where(within).distinct()).scalars())


def _put_runs(connection: sa.Connection, runs: Iterable[CataloguedRun], elsewhere: Mapping[str, str]) -> None:
    for run in sorted(runs, key=lambda run: run.run_id):
        query = sa.select(schema.run).where(schema.run.c.run_id == run.run_id)
        known = connection.execute(query).mappings().first()
        ended = known is not None and known["success"] is not None
        if known is not None and known["bag"] == elsewhere.get(run.run_id) and (ended or run.success is None):
            continue
        values = asdict(run)
        if known is not None and ended and run.success is None:
            values = {**known, **{name: values[name] for name in _PLACE}}
        _put(connection, schema.run, values)


def _holds(bag: str, sha256: str) -> bool:
    """True where a folder holds the bag of this checksum."""
    try:
        return content_of_bag(Path(bag)).sha256 == sha256
    except OSError:
        return False


def _put(connection: sa.Connection, table: sa.Table, values: dict[str, Any]) -> None:
    """Insert a row, or put it in place of the one of its key."""
    insert = insert_into(connection, table).values(values)
    others = {name: insert.excluded[name] for name in values if not table.c[name].primary_key}
    connection.execute(insert.on_conflict_do_update(index_elements=list(table.primary_key), set_=others))


def _of_cells(cells: Collection[str] | sa.Select[Any]) -> sa.ColumnElement[bool]:
    """Inspections of runs of these cells, as a condition."""
    runs = sa.select(schema.run.c.run_id).where(schema.run.c.cell.in_(cells))
    return schema.inspection.c.run_id.in_(runs)


def _by_run(
    connection: sa.Connection, table: sa.Table, ids: list[str], order: sa.Column[Any]
) -> dict[str, dict[str, Any]]:
    """The last row of each run in an order."""
    query = sa.select(table).where(table.c.run_id.in_(ids)).order_by(order, *table.primary_key)
    return {row["run_id"]: dict(row) for row in connection.execute(query).mappings()}
