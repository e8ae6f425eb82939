"""How a milled door came out where it was measured, and what a run is called by it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.units import m_to_mm

MILLED, NOT_MEASURED = "milled", "milled, not measured"
OUT_OF_TOLERANCE = "milled, out of tolerance"


@dataclass(frozen=True)
class MeasuredDoor:
    """The feature that is furthest from its recipe.

    Attributes:
        feature: Which; empty where nothing was measured.
        deviation: How far it is off [m].
        tolerance: How far it may be off [m].
    """

    feature: str = ""
    deviation: float = 0.0
    tolerance: float = 0.0

    @property
    def measured(self) -> bool:
        """Somebody measured the door."""
        return bool(self.feature)

    @property
    def out_of_tolerance(self) -> bool:
        """It was measured, and the feature is not within tolerance; what is no number is not within it."""
        return self.measured and not self.deviation <= self.tolerance

    @property
    def sentence(self) -> str:
        """What there is to say of the door, as the end of a sentence."""
        if not self.measured:
            return "not measured"
        return (
            f"{self.feature} is {m_to_mm(self.deviation):.2f} mm off where {m_to_mm(self.tolerance):.2f} mm "
            "are allowed"
        )

    def told_of(self, door_id: str, how: str) -> str:
        """What is said of a milled door: how it was milled, or what to do where it is out of tolerance."""
        if self.out_of_tolerance:
            return (
                f"door {door_id}: {OUT_OF_TOLERANCE}, {self.sentence}; find out what the model of the robot gets "
                "wrong (diagnose) before the next door"
            )
        return f"door {door_id} milled: {how}; {self.sentence}"

    @classmethod
    def worst(cls, deviations: Iterable[tuple[str, float]], tolerance: float) -> MeasuredDoor:
        """The worst of the features' names and deviations [m]; of none, a door that was not measured."""
        # What is no number is worse than any.
        found = max(
            deviations, key=lambda one: (not one[1] <= tolerance, one[1] != one[1], one[1]), default=None
        )
        return cls() if found is None else cls(found[0], float(found[1]), float(tolerance))


def outcome(success: bool, error_code: int, measured: bool) -> str:
    """What a run came to, in two or three words: milled, measured or not, or refused with its code."""
    if error_code == OutOfToleranceError.code:
        return OUT_OF_TOLERANCE
    if success:
        return MILLED if measured else NOT_MEASURED
    return f"refused ({error_code})"
