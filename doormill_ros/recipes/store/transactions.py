"""What everything that is kept in a database shares: its connections, transactions and failures."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Self

import sqlalchemy as sa

from doormill_ros.recipes.store.engine import WRITE, make_engine


class Transactions:
    """A database by its engine; a context manager.

    Attributes:
        url: Without its password.
    """

    def __init__(self, url: str | None) -> None:
        """Make the engine; nothing is connected yet.

        Args:
            url: See `make_engine`.

        Raises:
            DatabaseUnreachable: Not a URL, or of another kind of database.
        """
        self._engine = make_engine(url)
        self.url = self._engine.url.render_as_string(hide_password=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close every connection."""
        self._engine.dispose()

    def _told(self, error: sa.exc.InterfaceError | sa.exc.DatabaseError, reason: str) -> Exception:
        """What callers are told of a failure; the error itself where they are to see that."""
        raise NotImplementedError

    @contextmanager
    def _write(self) -> Iterator[sa.Connection]:
        """A transaction that is going to write."""
        with self._failures(), self._engine.connect() as connection:
            connection.execution_options(**{WRITE: True})
            with connection.begin():
                yield connection

    @contextmanager
    def _failures(self) -> Iterator[None]:
        """A failure of the database itself becomes what `_told` says."""
        try:
            yield
        except (sa.exc.InterfaceError, sa.exc.DatabaseError) as error:
            told = self._told(error, " ".join(str(error.orig).split()))
            if told is error:
                raise
            raise told from error
