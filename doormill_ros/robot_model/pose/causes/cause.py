"""What every cause of pose errors has to say about itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Cause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import Placement
from doormill_ros.robot_model.pose.view import SetView

#: Standard deviations from which on a number is told, and a cause of which none is has no size.
CLEAR = 2.0
#: Value, standard deviation and unit by name, and whatever else is told of a number.
Reported = dict[str, dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Columns:
    """How some coefficients of a cause displace a frame.

    Attributes:
        direction: Component of a frame twist, see `chain.direction`.
        first: Index of the first coefficient within the cause.
        basis: Displacement for a unit of every coefficient, shape (n, k).
    """

    direction: int
    first: int
    basis: FloatArray


@dataclass(frozen=True)
class Coefficient:
    """One fitted number.

    Attributes:
        name: Key under the cause's parameters.
        unit: SI unit.
        group: Coefficients of a group share a typical size that is learnt from the data.
        typical: Largest size that is plausible at all; where learning of the typical size begins.
    """

    name: str
    unit: str
    group: str
    typical: float


class PoseCause(Cause):
    """One way in which a real robot's poses can differ from the nominal ones, linear in its coefficients.

    One that is not of the robot holds for its series alone.

    Attributes:
        drawn_wrong: Whether it is how the robot was built, which is nobody's habit and not learnt from one series.
        for_lengths: Whether it is one share that stands for the lengths of several links.
        timed: Whether it acts by a course in time of few numbers, which tells how much each block gains by it.
    """

    drawn_wrong: bool = False
    for_lengths: bool = False
    timed: bool = False

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """This cause wherever it may act; a joint each unless a cause says otherwise."""
        return [cls(where) for where in hints.joints]

    @property
    def settings(self) -> dict[str, Any]:
        """What a model's file has to state besides the place."""
        return {}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any], dh: FloatArray) -> PoseCause:
        """The cause of a model's file.

        Args:
            where: Place.
            settings: Holds at least those of `settings`.
            dh: The model's table, shape (J, 4).

        Raises:
            KeyError: A setting is missing.
        """
        return cls(where)

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """All fitted numbers."""
        raise NotImplementedError

    @property
    def imitated(self) -> int:
        """How many of the coefficients, from the first on, another cause imitates; it is real by the others alone."""
        return 0

    @property
    def driver_elsewhere(self) -> str:
        """What drives it, as laws at other places have it; empty where such a law is no doubt about it."""
        return ""

    def impossible(self, x: FloatArray) -> bool:
        """Whether no such cause can have coefficients, shape (k,)."""
        return False

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """What is told of its numbers.

        Args:
            x: Coefficients, shape (k,).
            std: Their standard deviations, shape (k,).
            seen: The series, and where each stands.
        """
        return {
            c.name: {"value": float(v), "std": float(s), "unit": c.unit}
            for c, v, s in zip(self.coefficients, x, std, strict=True)
        }

    def spectrum(self, x: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Of an error of a joint's own angle: orders and amplitudes by coefficients (k,), shape (n,) each [rad]."""
        return None

    def doubt(self, reported: Mapping[str, Mapping[str, Any]]) -> str:
        """What else it may be with the numbers that are told, as a sentence; empty where nothing else is known."""
        return ""

    def meaning(self, reported: Mapping[str, Mapping[str, Any]]) -> str:
        """What the numbers that are told mean, as a sentence; empty where they say it themselves."""
        return ""

    def columns(self, view: SetView) -> list[Columns]:
        """Effect on the frames of a series; empty where the cause does not act."""
        raise NotImplementedError
