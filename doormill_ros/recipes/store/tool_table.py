"""The table of tools: their figures, what they have cut, and which of them must not be used."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from doormill_ros.errors import one_line
from doormill_ros.recipes.errors import (
    BrokenTool,
    DamagedRecord,
    DatabaseError,
    NotInTable,
    RecipeError,
    WornTool,
)
from doormill_ros.recipes.reading import read_value
from doormill_ros.recipes.recipe import AUTHOR, Recipe
from doormill_ros.recipes.store.connection import StoreConnection
from doormill_ros.recipes.store.schema import tool as tool_rows
from doormill_ros.recipes.store.schema import tool_use
from doormill_ros.recipes.store.statements import storable
from doormill_ros.recipes.tabled_tool import TabledTool, figures_of, read_tool_table


@dataclass(frozen=True)
class ToolRecord:
    """A tool and its state.

    Attributes:
        tool: Figures, and what it has cut.
        broken: Somebody has found it broken.
        author: Who changed it last, by hand.
        changed: When, UTC.
    """

    tool: TabledTool
    broken: bool
    author: str
    changed: datetime

    def check(self) -> None:
        """Refuse a tool that must not be used.

        Raises:
            BrokenTool: It is marked as broken.
            WornTool: It has cut as far as it may.
        """
        name, tool = self.tool.name, self.tool
        remedy = f"put a new one into its place and say so (recipes tools renew {name})"
        if self.broken:
            raise BrokenTool(
                f"found tool {name!r} marked as broken, allowed are whole ones; {remedy}", found=name
            )
        if tool.left <= 0.0:
            raise WornTool(
                f"found tool {name!r} after {tool.cut:.1f} m of cut, allowed are {tool.life:g} m; {remedy}",
                found=tool.cut,
                allowed=tool.life,
            )


class ToolTable:
    """The tools of one database, each of which exists once.

    Args:
        store: The open database.
        clock: Gives the time of a change with its offset from UTC.
    """

    def __init__(self, store: StoreConnection, clock: Callable[[], datetime]) -> None:
        self._store = store
        self._clock = clock

    def list(self) -> tuple[ToolRecord, ...]:
        """Every tool, sorted by name."""
        return self._records(sa.select(tool_rows))

    def get(self, name: str) -> ToolRecord:
        """One tool; raises NotInTable."""
        found = self._some([name])
        if not found:
            raise _not_in_table(name)
        return found[0]

    def look_up(self, names: Collection[str]) -> dict[str, TabledTool]:
        """Those of some tools that the table has, by name."""
        return {record.tool.name: record.tool for record in self._some(names)}

    def save_all(self, tools: Iterable[TabledTool], author: str) -> tuple[str, ...]:
        """Store tools that are new or have other figures, all of them or none; what they have cut stays.

        Args:
            tools: What to store.
            author: Who does, at most 100 printable characters.

        Returns:
            Names of those that changed.

        Raises:
            BadText: The author is none.
        """
        read_value(AUTHOR.read, author, "author")
        changed = []
        with self._store.write() as connection:
            for tool in sorted(tools, key=lambda tool: tool.name):
                document = json.dumps(figures_of(tool), separators=(",", ":"))
                here = tool_rows.c.name == tool.name
                before = connection.execute(sa.select(tool_rows.c.document).where(here)).scalar()
                values: dict[str, Any] = {"document": document, "author": author, "changed": self._now()}
                if before is None:
                    values |= {"name": tool.name, "cut": 0.0, "broken": False}
                    connection.execute(tool_rows.insert().values(values))
                elif before != document:
                    connection.execute(tool_rows.update().where(here).values(values))
                if before != document:
                    changed.append(tool.name)
        return tuple(changed)

    def renew(self, name: str, author: str) -> None:
        """A new or sharpened tool stands in its place: it has cut nothing and is whole; raises NotInTable."""
        self._set(name, author, cut=0.0, broken=False)

    def mark_broken(self, name: str, author: str) -> None:
        """It must not be used until it is renewed; raises NotInTable."""
        self._set(name, author, broken=True)

    def check(self, recipe: Recipe) -> None:
        """Refuse a recipe for a run because of one of its tools.

        Raises:
            BrokenTool: One is marked as broken.
            WornTool: One has cut as far as it may.
        """
        names = [name for name, tool in recipe.tools.items() if isinstance(tool, TabledTool)]
        for record in self._some(names):
            record.check()

    def expect(self, run_id: str, metres: Mapping[str, float]) -> None:
        """Note what a run is going to cut, until it does; what was noted of it before counts no more.

        Args:
            run_id: Which run.
            metres: By tool of the table [m].
        """
        with self._store.write() as connection:
            same = tool_use.c.run_id == run_id
            if connection.execute(sa.select(tool_use).where(same, tool_use.c.counted)).first() is not None:
                return
            connection.execute(tool_use.delete().where(same))
            for name in sorted(metres):
                row = {"run_id": run_id, "tool": name, "metres": metres[name], "counted": False}
                connection.execute(tool_use.insert().values(row))

    def count(self, run_id: str) -> None:
        """A run cuts or has cut what was expected of it: added to its tools, once however often this is called."""
        open_ones = sa.and_(tool_use.c.run_id == run_id, sa.not_(tool_use.c.counted))
        if not self._store.read(sa.select(tool_use.c.tool).where(open_ones)):
            return
        with self._store.write() as connection:
            done = tool_use.update().where(open_ones).values(counted=True)
            for row in connection.execute(done.returning(tool_use.c.tool, tool_use.c.metres)).all():
                more = tool_rows.update().where(tool_rows.c.name == row.tool)
                connection.execute(more.values(cut=tool_rows.c.cut + row.metres))

    def _set(self, name: str, author: str, **values: object) -> None:
        read_value(AUTHOR.read, author, "author")
        if not storable(name):
            raise _not_in_table(name)
        with self._store.write() as connection:
            update = tool_rows.update().where(tool_rows.c.name == name)
            done = connection.execute(update.values(author=author, changed=self._now(), **values))
            if not done.rowcount:
                raise _not_in_table(name)

    def _some(self, names: Collection[str]) -> tuple[ToolRecord, ...]:
        known = [name for name in names if storable(name)]
        return self._records(sa.select(tool_rows).where(tool_rows.c.name.in_(known))) if known else ()

    def _records(self, query: sa.Select[tuple[object, ...]]) -> tuple[ToolRecord, ...]:
        records = [_record(row) for row in self._store.read(query)]
        return tuple(sorted(records, key=lambda record: record.tool.name))

    def _now(self) -> str:
        return self._clock().astimezone(UTC).isoformat()


def _record(row: sa.Row[Any]) -> ToolRecord:
    try:
        (tool,) = read_tool_table({row.name: json.loads(row.document)}).values()
        changed = datetime.fromisoformat(row.changed)
    except (ValueError, TypeError, RecursionError, RecipeError) as error:
        raise DamagedRecord(
            f"tool {row.name!r} of the table is not what was stored ({one_line(str(error))}); import it again, or "
            "restore a backup",
            found=row.name,
        ) from error
    return ToolRecord(replace(tool, cut=row.cut), bool(row.broken), row.author, changed)


def _not_in_table(name: str) -> DatabaseError:
    return NotInTable(
        f"found no tool {name!r} in the table of tools; see recipes tools list, or import it", found=name
    )
