"""The seam between a robot that bends and everybody who needs to know by how much."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from doormill_ros.arrays import FloatArray


class ComplianceModel(Protocol):
    """Predicts how far the loaded robot gives way."""

    def deflection(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Twist of the loaded tool.

        Args:
            q: Commanded joint angles, shape (n, 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (n, 6) [N, N m].
            load_point: Point in the flange frame at which the wrench acts, shape (3,) [m].
            direction: Direction of each joint's last motion, -1, 0 (unknown) or +1, shape (n, 6).

        Returns:
            Displacement of the load point and rotation of the flange, base axes, shape (n, 6) [m, rad].
        """
        ...


def remembers(model: ComplianceModel) -> bool:
    """Whether a model's deflections hang on how the joints moved last; those of one that does not tell may."""
    return bool(getattr(model, "remembers", True))


@dataclass(frozen=True, eq=False)
class StandingSpread:
    """What is left to chance of where n unloaded tools stand.

    Attributes:
        joints: Displacement by one standard deviation of each joint's spring, shape (n, 6, 3) [m].
        rest: Standard deviation of what does not come from the springs, shape (n,) [m].
    """

    joints: FloatArray
    rest: FloatArray


@runtime_checkable
class StandingModel(ComplianceModel, Protocol):
    """A model whose tool is off without any load, too; `deflection` includes that."""

    def standing(
        self, q: FloatArray, load_point: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """Twist of the unloaded tool; arguments and shapes as `ComplianceModel.deflection`."""
        ...

    def standing_spread(self, q: FloatArray, load_point: FloatArray, relative: FloatArray) -> StandingSpread:
        """How well that is known.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            load_point: Flange frame, shape (3,) [m].
            relative: Standard deviation of each spring as a share of it, shape (6,).
        """
        ...
