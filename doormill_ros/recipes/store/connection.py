"""The connections to a recipe database: what reads, what writes, and what a failure of it becomes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sqlalchemy as sa

from doormill_ros.recipes.errors import DatabaseUnreachable
from doormill_ros.recipes.store import schema
from doormill_ros.recipes.store.engine import make_reader
from doormill_ros.recipes.store.transactions import Transactions


class StoreConnection(Transactions):
    """A database of recipes that is open, made where it is not there, migrated where it is old.

    Args:
        url: See `make_engine`.

    Raises:
        DatabaseUnreachable: Nothing answers, or it is not a database of recipes.
        SchemaTooNew: A later release has written it.
    """

    def __init__(self, url: str | None = None) -> None:
        super().__init__(url)
        self._reader = make_reader(self._engine)
        try:
            with self._failures(), self._reader.connect() as connection:
                current = schema.current_revision(connection)
            if current != schema.REVISIONS[-1]:
                with self.write() as connection:
                    schema.migrate(connection)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close every connection."""
        self._reader.dispose()
        super().close()

    def read(self, query: sa.Select[Any], values: dict[str, object] | None = None) -> Sequence[sa.Row[Any]]:
        """Every row of one statement, which is all that a look-up is: no transaction round it."""
        with self._failures():
            try:
                return self._rows(query, values)
            except sa.exc.DBAPIError as error:
                if not error.connection_invalidated:
                    raise
                # The server was started anew since the last look-up. To ask it before each one
                # whether it is still there would cost a journey every time.
                return self._rows(query, values)

    def _rows(self, query: sa.Select[Any], values: dict[str, object] | None) -> Sequence[sa.Row[Any]]:
        with self._reader.connect() as connection:
            return connection.execute(query, values).all()

    def _told(self, error: sa.exc.InterfaceError | sa.exc.DatabaseError, reason: str) -> Exception:
        if isinstance(error, sa.exc.IntegrityError):
            return error
        return DatabaseUnreachable(f"the recipe database {self.url} cannot be used: {reason}")
