"""Something that changed in a cell by the bags of its runs alone: since which run, and how large it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from doormill_ros.cell.places.layout import OFFSETS
from doormill_ros.units import m_to_mm, rad_to_mrad

STEP, DRIFT = "step", "drift"
#: Of one shift, as doors were found and as marks show it; the first that is there is said.
_SAID = ("offset", "moved", "factor")


@dataclass(frozen=True)
class ChangeSize:
    """How large a change is in one number.

    Attributes:
        name: offset_y, offset_z, offset_rotation, the same by marks (moved_y, ...), or factor.
        value: After the change against before it, of a drift the last run against the first [m, rad or 1].
        unit: m, rad or 1.
    """

    name: str
    value: float
    unit: str

    @property
    def words(self) -> str:
        """As a part of a sentence."""
        axis = self.name.partition("_")[2]
        if self.unit == "m":
            return f"{axis} {m_to_mm(self.value):+.2f} mm"
        if self.unit == "rad":
            return f"{axis} {rad_to_mrad(self.value):+.2f} mrad"
        return f"{self.value:.2f} times"


@dataclass(frozen=True)
class CellChange:
    """A change and since when.

    Attributes:
        cause, where: Name and place.
        course: STEP or DRIFT.
        from_run: First run with it; of a drift the first that was asked.
        earliest, latest: Runs between which it began, 95 %; of a drift both are `from_run`.
        sizes: How large it is.
        tied_with: Other causes that the bags cannot tell from this one.
    """

    cause: str
    where: str
    course: str
    from_run: str
    earliest: str
    latest: str
    sizes: tuple[ChangeSize, ...] = ()
    tied_with: tuple[str, ...] = ()

    @property
    def said_sizes(self) -> tuple[ChangeSize, ...]:
        """Those that stand in a sentence: of one shift not twice the same."""
        kinds = [kind for kind in _SAID if any(size.name.startswith(kind) for size in self.sizes)]
        return tuple(size for size in self.sizes if size.name.startswith(kinds[0])) if kinds else ()

    @property
    def words(self) -> str:
        """The change as a part of a sentence."""
        sizes = ", ".join(size.words for size in self.said_sizes)
        name = f"{_plain(self.cause)} at {self.where}" + (f" ({sizes})" if sizes else "")
        if self.course == DRIFT:
            since = f"that drifts from run {self.from_run} on"
        else:
            between = f" (95 %: {self.earliest} to {self.latest})" if self.earliest != self.latest else ""
            since = f"from run {self.from_run} on{between}"
        others = " or ".join(_plain(cause) for cause in self.tied_with)
        return f"{name} {since}" + (f", which the bags cannot tell from {others}" if others else "")


def changes_in(document: Mapping[str, Any]) -> tuple[CellChange, ...]:
    """The changes of a diagnosis.json of bags.

    Raises:
        KeyError, TypeError, ValueError: It is no such document.
    """
    causes: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for cause in document["causes"]:
        causes.setdefault((cause["cause"], cause["where"]), []).append(cause)
    return tuple(_change(one, causes.get((one["what"], one["where"]), [])) for one in document["changes"])


def _change(told: Mapping[str, Any], causes: Sequence[Mapping[str, Any]]) -> CellChange:
    units = {name: one["unit"] for cause in causes for name, one in cause["parameters"].items()}
    tied = dict.fromkeys(str(one["cause"]) for cause in causes for one in cause.get("tied_with", ()))
    first, last = told["from_run_ci95"]
    sizes = [
        size for name, value in told["after"].items() for size in _sizes(name, value, units.get(name, "1"))
    ]
    return CellChange(
        str(told["what"]),
        str(told["where"]),
        str(told["kind"]),
        str(told["from_run"]),
        str(first),
        str(last),
        tuple(sizes),
        tuple(tied),
    )


def _sizes(name: str, value: Any, unit: str) -> list[ChangeSize]:
    if isinstance(value, list):  # along all axes, or the first of them
        return [
            ChangeSize(f"{name}_{axis}", float(one), own)
            for axis, own, one in zip(OFFSETS, unit.split(", "), value, strict=False)
        ]
    return [ChangeSize(name, float(value), unit)]


def _plain(name: str) -> str:
    return name.replace("_", " ")
