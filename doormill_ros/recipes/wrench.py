"""The process wrench of a feature, segment by segment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.errors import MissingField, OutOfRange, UnknownField, WrongType
from doormill_ros.recipes.fields import GRID_DECIMALS, Codec, as_mapping, join, number

DEFAULT = "default"
FORCE_LIMIT = 5000.0  #: N; five times what a spindle of 5 kW gives at the speeds of the thesis
MOMENT_LIMIT = 1000.0  #: N m
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


@dataclass(frozen=True)
class WrenchTable:
    """Mean wrench on the tool while it cuts a segment, thesis table 4.8.

    The axes are the tool's nominal ones: z into the wood, x along the feature's -y, y along the
    feature's x. For a feature on the face these are the flange axes of the robot in its home
    orientation. `Feature.wrench` moves a wrench to the tool centre point.

    Attributes:
        rows: Segment name and (Fx, Fy, Fz, Mx, My, Mz) [N, N m], sorted by name, the default last.
    """

    rows: tuple[tuple[str, tuple[float, float, float, float, float, float]], ...]

    def get(self, segment: str) -> FloatArray:
        """Wrench of a segment, or the default, shape (6,) [N, N m].

        Raises:
            KeyError: The table has neither; a checked recipe always has one.
        """
        rows = dict(self.rows)
        return np.array(rows[segment] if segment in rows else rows[DEFAULT])


@dataclass(frozen=True)
class WrenchRows(Codec):
    """Codec of a wrench table: segment name to six numbers [N, N m]."""

    def key(self, name: str) -> str:
        """See the base class; the method `Feature.wrench` has the short name in the code."""
        return "wrench_n_nm"

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> WrenchTable:
        """See the base class."""
        rows = []
        for segment, row in as_mapping(value, path).items():
            where = join(path, segment)
            if not isinstance(row, list | tuple) or len(row) != 6:
                raise WrongType(where, f"found {row!r}, allowed are six numbers {COMPONENTS}", found=row)
            rows.append((segment, tuple(_component(index, cell, where) for index, cell in enumerate(row))))
        # One order whatever the document's: tables of equal content are equal.
        return WrenchTable(tuple(sorted(rows, key=lambda row: (row[0] == DEFAULT, row[0]))))

    def load(self, value: Mapping[str, Any], context: Mapping[str, Any]) -> WrenchTable:
        """See the base class."""
        return WrenchTable(tuple((segment, tuple(row)) for segment, row in value.items()))

    def write(self, value: WrenchTable) -> dict[str, list[float]]:
        """See the base class."""
        return {segment: list(row) for segment, row in value.rows}


def _component(index: int, cell: Any, where: str) -> float:
    limit, unit = (FORCE_LIMIT, "N") if index < 3 else (MOMENT_LIMIT, "N m")
    if type(cell) is float and abs(cell) <= limit:
        return round(cell, GRID_DECIMALS) + 0.0  # nothing to say: no path is built for a message
    found = number(cell, join(where, index))
    if abs(found) > limit:
        raise OutOfRange(
            join(where, index),
            f"found {found:g} {unit}, allowed are {-limit:g} to {limit:g} {unit}",
            found=found,
        )
    return found


def check_segments(table: WrenchTable, segments: tuple[str, ...], path: str) -> None:
    """Every segment has a wrench and every wrench a segment.

    Args:
        table: The table to check.
        segments: Names of the feature's segments.
        path: Dotted path of the table.

    Raises:
        UnknownField: A row for a segment that the feature lacks.
        MissingField: A segment without a row, and no default.
    """
    given = [segment for segment, _ in table.rows]
    for segment in given:
        if segment != DEFAULT and segment not in segments:
            allowed = ", ".join([*segments, DEFAULT])
            raise UnknownField(join(path, segment), f"is not a segment, allowed are {allowed}", found=segment)
    for segment in segments:
        if segment not in given and DEFAULT not in given:
            raise MissingField(
                join(path, segment), f"is missing; give it, or '{DEFAULT}' for every segment", found=None
            )
