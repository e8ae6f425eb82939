"""How far a tool comes forward as its cell warms up, as doors told it: a law in time, and how sure that is.

The way goes to growth (1 - exp(-t / hours)), t after the cell began to work. A few doors tell a growth better than its
time constant, so a law holds several, each with what the doors give for it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.robot_model.warmth.work_times import WorkTimes

#: Times what the doors saw of the work, up to which a law is followed. A growth that goes ever more slowly has at most
#: twice as much by then: had it stood still from the last door on, what is undone too much would be no more than was.
AHEAD = 2.0
REACH = 2.0  #: from base to flange at which a growth of the whole arm is told [m]


@dataclass(frozen=True)
class GrowthLaw:
    """Growth of one time constant.

    Attributes:
        hours: Time constant [h].
        growth: In the end [m].
        std: Its standard deviation [m].
        weight: Probability of the time constant, those of a law add up to 1.
    """

    hours: float
    growth: float
    std: float
    weight: float


@dataclass(frozen=True)
class ThermalGrowth:
    """A growth away from the base.

    Attributes:
        laws: At least one.
        seen: From the first to the last door that told it [h].
        takt: Between doors that told it, the median [s]; a longer time is a pause.
        arm: Whether all lengths of the arm grow by one share, so that the tool moves in proportion to the way from base
            to flange, and as told at `REACH`; else it comes forward by as much wherever it is.
    """

    laws: tuple[GrowthLaw, ...]
    seen: float
    takt: float
    arm: bool = False

    def at(self, work: WorkTimes, moment: float) -> tuple[float, float]:
        """Way of the tool away from the base, at `REACH` where `arm` grows, and its standard deviation [m].

        Args:
            work: When the cell worked.
            moment: When a door is milled [s since the epoch].
        """
        return self._way([work.warmth(moment, law.hours, self.takt) for law in self.laws])

    def after(self, hours: float) -> tuple[float, float]:
        """The same after work without a pause [h]."""
        return self._way([-np.expm1(-hours / law.hours) for law in self.laws])

    def _way(self, warmth: Sequence[float]) -> tuple[float, float]:
        weight = np.array([law.weight for law in self.laws])
        most = [-np.expm1(-AHEAD * self.seen / law.hours) for law in self.laws]
        warm = np.minimum(warmth, most)
        way = warm * [law.growth for law in self.laws]
        size = float(weight @ way)
        variance = weight @ ((way - size) ** 2 + (warm * [law.std for law in self.laws]) ** 2)
        return size, float(np.sqrt(variance))

    def document(self) -> dict[str, Any]:
        """As model.yaml has it."""
        return {
            "seen": self.seen,
            "takt": self.takt,
            "arm": self.arm,
            "laws": [dict(vars(law)) for law in self.laws],
        }


def growth_of(document: Mapping[str, Any]) -> ThermalGrowth:
    """The section `thermal_growth` of model.yaml.

    Raises:
        KeyError, TypeError, ValueError: It is not of its form.
    """
    names = "hours", "growth", "std", "weight"
    entries = document["laws"]
    if not isinstance(entries, list) or not entries:
        raise ValueError(f"laws of thermal_growth is {entries!r:.80}, allowed is a list of at least one")
    laws = tuple(GrowthLaw(*(float(entry[name]) for name in names)) for entry in entries)
    arm = document.get("arm", False)
    if not isinstance(arm, bool):
        raise ValueError(f"arm of thermal_growth is {arm!r:.80}, allowed are true and false")
    found = ThermalGrowth(laws, float(document["seen"]), float(document["takt"]), arm)
    if not all(np.isfinite([found.seen, found.takt, *(v for law in laws for v in vars(law).values())])):
        raise ValueError("thermal_growth has a number that is not finite, allowed are finite ones")
    least = min(min(law.std, law.weight) for law in laws)
    if min(found.seen, found.takt, least) < 0.0 or min(law.hours for law in laws) <= 0.0:
        raise ValueError("thermal_growth has a negative number, allowed are 0 and more, of hours more than 0")
    if abs(sum(law.weight for law in laws) - 1.0) > 1e-6:
        raise ValueError(
            f"weights of thermal_growth add up to {sum(law.weight for law in laws):g}, allowed is 1"
        )
    return found
