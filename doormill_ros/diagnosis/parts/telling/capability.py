"""How capable the process is: deviations of each recipe against the tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.pages.page import Block, Paragraphs, Table
from doormill_ros.units import m_to_um

ORIGIN = "0.5 mm, section 1.3 of the thesis"  #: of the tolerance


def capability_of(doors: Sequence[GaugedDoor]) -> list[dict[str, Any]]:
    """By recipe, of all points that were matched: doors and points, mean and standard deviations [m], Cpk and Ppk.

    `std` is that of all points, and Ppk follows from it; `std_within` is that about the mean of each door, and Cpk
    follows from that. What so few points cannot tell is None.
    """
    rows = []
    for recipe in dict.fromkeys(door.recipe for door in doors):
        each = [door.points.deviation for door in doors if door.recipe == recipe]
        off = np.concatenate(each)
        mean = float(off.mean())
        room = (TOLERANCE - abs(mean)) / 3.0
        std, within = _deviation([off]), _deviation(each)
        figures = {"mean": mean, "std": std, "std_within": within}
        rows.append(
            {"recipe": recipe, "doors": len(each), "points": len(off)}
            | figures
            | {"cpk": room / within if within else None, "ppk": room / std if std else None}
        )
    return rows


def _deviation(parts: Sequence[FloatArray]) -> float | None:
    """Standard deviation about the mean of each part, shape (n,) [m]; None where no part has two points."""
    freedom = sum(len(part) - 1 for part in parts)
    if not freedom:
        return None
    return float(np.sqrt(sum(np.sum((part - part.mean()) ** 2) for part in parts) / freedom))


def capability_table(capability: Sequence[dict[str, Any]]) -> list[Block]:
    """On the page."""
    heads = (
        "Recipe",
        "Doors",
        "Points",
        "Mean deviation [um]",
        "Standard deviation [um]",
        "within doors [um]",
    )
    rows = [
        [
            row["recipe"],
            str(row["doors"]),
            str(row["points"]),
            f"{m_to_um(row['mean']):+.0f}",
            *("-" if row[key] is None else f"{m_to_um(row[key]):.0f}" for key in ("std", "std_within")),
            *("-" if row[key] is None else f"{row[key]:.2f}" for key in ("cpk", "ppk")),
        ]
        for row in capability
    ]
    note = (
        f"Cpk and Ppk are against a tolerance of {ORIGIN}, over the points that count: Cpk by the standard deviation "
        "within doors, Ppk by that of all."
    )
    return [Table((*heads, "Cpk", "Ppk"), rows), Paragraphs([note])]
