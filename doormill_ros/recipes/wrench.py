"""The process wrench of a feature, segment by segment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import WRENCH_COMPONENTS
from doormill_ros.recipes.errors import MissingField, OutOfRange, UnknownField, WrongType
from doormill_ros.recipes.quantities import GRID_DECIMALS, complaint, number, schema
from doormill_ros.recipes.reading import join, no_mapping

DEFAULT = "default"
FORCE_LIMIT = 5000.0  #: N; five times what a spindle of 5 kW gives at the speeds of the thesis
MOMENT_LIMIT = 1000.0  #: N m
LIMITS = (FORCE_LIMIT,) * 3 + (MOMENT_LIMIT,) * 3
Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class WrenchTable:
    """Mean wrench on the tool while it cuts a segment, thesis table 4.8.

    The axes are the tool's nominal ones: z into the wood, x along the feature's -y, y along the
    feature's x. For a feature on the face these are the flange axes of the robot in its home
    orientation. `Feature.wrench` moves a wrench to the tool centre point.

    Attributes:
        rows: Segment name and (Fx, Fy, Fz, Mx, My, Mz) [N, N m], sorted by name, the default last.
    """

    rows: tuple[tuple[str, Six], ...]

    def get(self, segment: str) -> FloatArray:
        """Wrench of a segment, or the default, shape (6,) [N, N m].

        Raises:
            KeyError: The table has neither; a checked recipe always has one.
        """
        rows = dict(self.rows)
        return np.array(rows[segment] if segment in rows else rows[DEFAULT])


class WrenchRows:
    """Annotation of a wrench table: segment name to six numbers [N, N m] in the document."""

    def key(self, name: str) -> str:
        """Name in the document; the method `Feature.wrench` has the short name in the code."""
        return "wrench_n_nm"

    def read(self, value: Any) -> WrenchTable:
        """The table; raises `complaint`."""
        mistake = no_mapping(value)
        if mistake is not None:
            raise complaint(WrongType, mistake[0], found=mistake[1])
        rows = []
        for segment, row in value.items():
            if not isinstance(row, list | tuple) or len(row) != 6:
                raise complaint(
                    WrongType,
                    f"found {row!r}, allowed are six numbers {WRENCH_COMPONENTS}",
                    (segment,),
                    found=row,
                )
            rows.append((segment, _six(segment, row)))
        # One order whatever the document's: tables of equal content are equal.
        return WrenchTable(tuple(sorted(rows, key=lambda row: (row[0] == DEFAULT, row[0]))))

    def write(self, value: WrenchTable) -> dict[str, list[float]]:
        """The document's rows."""
        return {segment: list(row) for segment, row in value.rows}

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read, self.write)


def _six(segment: str, row: Sequence[Any]) -> Six:
    for cell, limit in zip(row, LIMITS, strict=True):
        if type(cell) is not float or not -limit <= cell <= limit:
            row = [_component(segment, index, cell) for index, cell in enumerate(row)]
            break
    fx, fy, fz, mx, my, mz = [round(cell, GRID_DECIMALS) + 0.0 for cell in row]
    return fx, fy, fz, mx, my, mz


def _component(segment: str, index: int, cell: Any) -> float:
    found = number(cell, inside=(segment, index))
    limit, unit = LIMITS[index], "N" if index < 3 else "N m"
    if abs(found) > limit:
        raise complaint(
            OutOfRange,
            f"found {found:g} {unit}, allowed are {-limit:g} to {limit:g} {unit}",
            (segment, index),
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
