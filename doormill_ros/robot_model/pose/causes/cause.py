"""What every cause of pose errors has to say about itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Cause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.view import SetView


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
    """

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

    def columns(self, view: SetView) -> list[Columns]:
        """Effect on the frames of a series; empty where the cause does not act."""
        raise NotImplementedError
