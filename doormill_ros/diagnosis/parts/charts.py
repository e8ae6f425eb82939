"""Charts of a shift: each door's residual in control limits, its cumulated sum, and how capable the process is.

Residuals are against what is assumed of the door's own recipe, so another recipe by itself moves no chart. The limits
of the chart of individuals are the mean and 2.66 mean moving ranges (1.128 is the expected range of two normal numbers
in standard deviations); they and those of the sums come from the doors before the first change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.cell.summary import TOLERANCE
from doormill_ros.diagnosis.parts.problem import DoorDiagnosis
from doormill_ros.pages.charts import BLUE, GREY, RED, Curve, scatter
from doormill_ros.pages.page import Block, Charts, Paragraphs, Table
from doormill_ros.units import m_to_um

_RANGE = 1.128  #: expected moving range of two, in standard deviations
_LIMIT = 3.0  #: standard deviations
_SLACK, _ALARM = 0.5, 5.0  #: of the cumulated sums, in standard deviations
_FEWEST = 3  #: doors from which limits are made
ORIGIN = "0.5 mm, section 1.3 of the thesis"  #: of the tolerance


@dataclass(frozen=True, eq=False)
class ShiftCharts:
    """Charts of d doors.

    Attributes:
        names, recipes: Of the doors.
        now: Root mean square residual of the model as it is, shape (d,) [m].
        extended: Of the extended model, shape (d,) [m].
        centre, sigma: Mean of `now` and its standard deviation from moving ranges, over the doors of the limits [m].
        limits_from: Numbers of the first and last door that the limits were made of.
        above, below: Cumulated sums in standard deviations, shape (d,).
        capability: By recipe: doors, mean and standard deviation of deviations [m], Cpk.
    """

    names: tuple[str, ...]
    recipes: tuple[str, ...]
    now: FloatArray
    extended: FloatArray
    centre: float
    sigma: float
    limits_from: tuple[int, int]
    above: FloatArray
    below: FloatArray
    capability: Sequence[dict[str, Any]]

    @property
    def limits(self) -> tuple[float, float]:
        """Of the chart of individuals [m]."""
        return max(self.centre - _LIMIT * self.sigma, 0.0), self.centre + _LIMIT * self.sigma

    def document(self) -> dict[str, Any]:
        """As diagnosis.json has them."""
        low, high = self.limits
        first, last = (self.names[end] for end in self.limits_from)
        return {
            "doors": [
                {"door": n, "recipe": r, "residual": float(a), "residual_extended": float(b)}
                for n, r, a, b in zip(self.names, self.recipes, self.now, self.extended, strict=True)
            ],
            "individuals": {
                "of": "residual",
                "centre": self.centre,
                "limits": [low, high],
                "limits_origin": f"mean moving range of {first} to {last}",
                "beyond": [n for n, v in zip(self.names, self.now, strict=True) if not low <= v <= high],
            },
            "cusum": {
                "slack": _SLACK,
                "alarm": _ALARM,
                "above": self.above.tolist(),
                "below": self.below.tolist(),
            },
            "capability": [dict(row) for row in self.capability],
            "tolerance": {"limits": [-TOLERANCE, TOLERANCE], "limits_origin": ORIGIN},
        }

    def blocks(self) -> list[Block]:
        """On the page."""
        low, high = (m_to_um(end) for end in self.limits)
        number = np.arange(len(self.names), dtype=float)
        ends = number[[0, -1]]
        first, last = (self.names[end] for end in self.limits_from)
        drawings = [
            scatter(
                "Residual of each door",
                "door",
                "um",
                [
                    Curve("model now", BLUE, number, m_to_um(self.now)),
                    Curve("extended", GREY, number, m_to_um(self.extended)),
                ],
                [Curve("", RED, ends, np.full(2, end)) for end in (low, high)],
            ),
            scatter(
                "Cumulated sums",
                "door",
                "standard deviations",
                (),
                [
                    Curve("above", BLUE, number, self.above),
                    Curve("below", GREY, number, self.below),
                    Curve("", RED, ends, np.full(2, _ALARM)),
                ],
            ),
        ]
        rows = [
            [
                row["recipe"],
                str(row["doors"]),
                f"{m_to_um(row['mean']):+.0f}",
                f"{m_to_um(row['std']):.0f}",
                f"{row['cpk']:.2f}",
            ]
            for row in self.capability
        ]
        return [
            Charts(drawings, "halves"),
            Paragraphs([f"Limits (red) are those of {first} to {last}."]),
            Table(("Recipe", "Doors", "Mean deviation [um]", "Standard deviation [um]", "Cpk"), rows),
            Paragraphs([f"Cpk is against a tolerance of {ORIGIN}."]),
        ]


def charts_of(diagnosis: DoorDiagnosis, first_change: int | None) -> ShiftCharts:
    """Of a diagnosed shift.

    Args:
        diagnosis: What was found.
        first_change: Number of the door from which on something changed; None for nothing.
    """
    problem = diagnosis.problem
    count = len(problem.doors)
    now, extended = (
        _by_door(problem.door, count, fitted.prediction.residual[:, 0])
        for fitted in (diagnosis.baseline, diagnosis.extended)
    )
    end = count if first_change is None or first_change < _FEWEST else first_change
    centre = float(now[:end].mean())
    ranges = np.abs(np.diff(now[:end]))
    sigma = float(ranges.mean() / _RANGE) if len(ranges) else 0.0
    return ShiftCharts(
        tuple(door.name for door in problem.doors),
        tuple(door.recipe for door in problem.doors),
        now,
        extended,
        centre,
        sigma,
        (0, end - 1),
        *_sums((now - centre) / max(sigma, 1e-9)),
        _capability(diagnosis),
    )


def _by_door(door: IntArray, count: int, residual: FloatArray) -> FloatArray:
    squares = np.bincount(door, weights=residual**2, minlength=count)
    result: FloatArray = np.sqrt(squares / np.maximum(np.bincount(door, minlength=count), 1))
    return result


def _sums(z: FloatArray) -> tuple[FloatArray, FloatArray]:
    above, below = np.zeros(len(z)), np.zeros(len(z))
    up = down = 0.0
    for i, value in enumerate(z):
        up, down = max(0.0, up + value - _SLACK), max(0.0, down - value - _SLACK)
        above[i], below[i] = up, down
    return above, below


def _capability(diagnosis: DoorDiagnosis) -> list[dict[str, Any]]:
    """Of the deviations of all points of all doors of a recipe."""
    problem, rows = diagnosis.problem, []
    for recipe in dict.fromkeys(door.recipe for door in problem.doors):
        doors = [door for door in problem.doors if door.recipe == recipe]
        off = np.concatenate([door.points.deviation for door in doors])
        mean, std = float(off.mean()), float(off.std())
        cpk = (TOLERANCE - abs(mean)) / max(3.0 * std, 1e-12)
        rows.append({"recipe": recipe, "doors": len(doors), "mean": mean, "std": std, "cpk": float(cpk)})
    return rows
