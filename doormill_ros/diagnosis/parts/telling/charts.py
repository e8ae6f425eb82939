"""Charts of a shift: each door's residual in control limits, its cumulated sum, and how capable the process is.

Residuals are against what is assumed of the door's own recipe. What is wrong may still leave more of one recipe than of
another, so that centre, moving ranges and sums are those of one recipe, and another recipe by itself moves no chart;
the ranges of all recipes together make one standard deviation (1.128 is the expected range of two normal numbers in
standard deviations). Limits come from the doors before the first step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.telling.capability import ORIGIN, capability_of, capability_table
from doormill_ros.pages.charts import BLUE, GREY, RED, Curve, scatter
from doormill_ros.pages.page import Block, Charts, Paragraphs
from doormill_ros.units import m_to_um

_RANGE = 1.128  #: expected moving range of two, in standard deviations
_LIMIT = 3.0  #: standard deviations
_RANGE_LIMIT = 3.267  #: of the moving range, in mean ranges: three of its standard deviations above it
_SLACK, _ALARM = 0.5, 5.0  #: of the cumulated sums, in standard deviations
_FEWEST = 3  #: doors from which limits are made


@dataclass(frozen=True, eq=False)
class ShiftCharts:
    """Charts of d doors; nan where there is no figure.

    Attributes:
        names, recipes: Of the doors.
        now: Root mean square residual of the model as it is, shape (d,) [m].
        extended: Of the extended model, shape (d,) [m].
        ranges: From the door of the same recipe before, shape (d,) [m].
        centre: Mean of `now` over the doors of the limits that are of the door's recipe, shape (d,) [m].
        sigma: Standard deviation of `now` from moving ranges [m].
        before: How many doors the limits were made of.
        above, below: Cumulated sums in standard deviations, shape (d,).
        capability: By recipe, see `capability_of`.
    """

    names: tuple[str, ...]
    recipes: tuple[str, ...]
    now: FloatArray
    extended: FloatArray
    ranges: FloatArray
    centre: FloatArray
    sigma: float
    before: int
    above: FloatArray
    below: FloatArray
    capability: Sequence[dict[str, Any]]

    @property
    def limits(self) -> tuple[FloatArray, FloatArray]:
        """Of the chart of individuals, shape (d,) each [m]."""
        return np.maximum(self.centre - _LIMIT * self.sigma, 0.0), self.centre + _LIMIT * self.sigma

    @property
    def range_limit(self) -> float:
        """Of the chart of moving ranges [m]."""
        return _RANGE_LIMIT * _RANGE * self.sigma

    @property
    def origin(self) -> str:
        """Of the limits."""
        first, last = self.names[0], self.names[self.before - 1]
        if np.isfinite(self.sigma):
            return f"mean moving range of {first} to {last}, by recipe"
        return f"none: fewer than {_FEWEST} doors, or none twice of one recipe, before the first step"

    def document(self) -> dict[str, Any]:
        """As diagnosis.json has them."""
        low, high = self.limits
        first = [self.recipes.index(recipe) for recipe in dict.fromkeys(self.recipes)]
        return {
            "doors": [
                {"door": n, "recipe": r, "residual": float(a), "residual_extended": float(b)}
                for n, r, a, b in zip(self.names, self.recipes, self.now, self.extended, strict=True)
            ],
            "individuals": {
                "of": "residual",
                "by_recipe": [
                    {
                        "recipe": self.recipes[k],
                        "centre": _told(self.centre)[k],
                        "limits": _told([low[k], high[k]]),
                    }
                    for k in first
                ],
                "limits_origin": self.origin,
                "beyond": self._named((self.now < low) | (self.now > high)),
            },
            "moving_range": {
                "of": "residual",
                "values": _told(self.ranges),
                "centre": _told([_RANGE * self.sigma])[0],
                "limit": _told([self.range_limit])[0],
                "limits_origin": self.origin,
                "beyond": self._named(self.ranges > self.range_limit),
            },
            "cusum": {
                "slack": _SLACK,
                "alarm": _ALARM,
                "above": _told(self.above),
                "below": _told(self.below),
            },
            "capability": [dict(row) for row in self.capability],
            "tolerance": {"limits": [-TOLERANCE, TOLERANCE], "limits_origin": ORIGIN},
        }

    def _named(self, chosen: BoolArray) -> list[str]:
        return [name for name, is_one in zip(self.names, chosen, strict=True) if is_one]

    def blocks(self) -> list[Block]:
        """On the page."""
        number = np.arange(len(self.names), dtype=float)
        recipe, ends = np.array(self.recipes), number[[0, -1]]

        def curve(name: str, colour: str, values: FloatArray, rows: BoolArray | None = None) -> Curve:
            rows = np.isfinite(values) if rows is None else rows & np.isfinite(values)
            return Curve(name, colour, number[rows], values[rows])

        limits = [
            curve("", RED, m_to_um(end), recipe == one)
            for one in dict.fromkeys(self.recipes)
            for end in self.limits
        ]
        seen = np.isfinite(self.sigma)
        alarms = [Curve("", RED, ends, np.full(2, _ALARM))]
        drawings = [
            scatter(
                "Residual of each door",
                "door",
                "um",
                [
                    curve("model now", BLUE, m_to_um(self.now)),
                    curve("extended", GREY, m_to_um(self.extended)),
                ],
                [one for one in limits if len(one.x)],
            ),
            scatter(
                "Moving range from the door of the recipe before",
                "door",
                "um",
                [curve("model now", BLUE, m_to_um(self.ranges))],
                [Curve("", RED, ends, np.full(2, m_to_um(self.range_limit)))] if seen else [],
            ),
        ]
        if seen:
            sums = [curve("above", BLUE, self.above), curve("below", GREY, self.below), *alarms]
            drawings.append(scatter("Cumulated sums", "door", "standard deviations", (), sums))
        return [
            Charts(drawings, "halves"),
            Paragraphs([f"Limits (red): {self.origin}."]),
            *capability_table(self.capability),
        ]


def charts_of(diagnosis: DoorDiagnosis, first_step: int | None) -> ShiftCharts:
    """Of a diagnosed shift.

    Args:
        diagnosis: What was found.
        first_step: Number of the door from which on something was of another size; None for nothing.
    """
    problem = diagnosis.problem
    count = len(problem.doors)
    now, extended = (
        _by_door(problem.door, count, fitted.prediction.residual[:, 0])
        for fitted in (diagnosis.baseline, diagnosis.extended)
    )
    recipes = tuple(door.recipe for door in problem.doors)
    before = count if first_step is None else first_step
    centre, ranges, sigma = control(now, recipes, before)
    above, below = sums((now - centre) / max(sigma, 1e-9), recipes)
    return ShiftCharts(
        tuple(door.name for door in problem.doors),
        recipes,
        now,
        extended,
        ranges,
        centre,
        sigma,
        before,
        above,
        below,
        capability_of(problem.doors),
    )


def control(now: FloatArray, recipes: Sequence[str], before: int) -> tuple[FloatArray, FloatArray, float]:
    """Centres and moving ranges by recipe, shape (d,) each, and the standard deviation that the ranges tell.

    Args:
        now: A figure of each door, shape (d,).
        recipes: What the doors are.
        before: Number of doors, from the first on, that make limits.
    """
    recipe = np.array(recipes)
    centre, ranges = np.full(len(now), np.nan), np.full(len(now), np.nan)
    for one in dict.fromkeys(recipes):
        rows = np.flatnonzero(recipe == one)
        ranges[rows[1:]] = np.abs(np.diff(now[rows]))
        if np.any(rows < before):
            centre[rows] = now[rows[rows < before]].mean()
    known = ranges[:before][np.isfinite(ranges[:before])]
    if before < _FEWEST or not len(known):
        return np.full(len(now), np.nan), ranges, float("nan")
    return centre, ranges, float(known.mean() / _RANGE)


def sums(z: FloatArray, recipes: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Cumulated sums of each recipe, upwards and downwards, of figures in standard deviations; shape (d,) each."""
    above, below = np.full(len(z), np.nan), np.full(len(z), np.nan)
    at: dict[str, tuple[float, float]] = {}
    for i in np.flatnonzero(np.isfinite(z)).tolist():
        up, down = at.get(recipes[i], (0.0, 0.0))
        at[recipes[i]] = max(0.0, up + z[i] - _SLACK), max(0.0, down - z[i] - _SLACK)
        above[i], below[i] = at[recipes[i]]
    return above, below


def _told(values: FloatArray | Sequence[float]) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _by_door(door: IntArray, count: int, residual: FloatArray) -> FloatArray:
    squares = np.bincount(door, weights=residual**2, minlength=count)
    result: FloatArray = np.sqrt(squares / np.maximum(np.bincount(door, minlength=count), 1))
    return result
