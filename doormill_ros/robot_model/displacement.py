"""Where a tool stands beside its place on the door although nothing loads it: as doors showed it, and for a model.

A door that stands displaced by t and turned by r about the base's x after it was looked at has the tool, at p, on the
other side of its place: the twist is (-(t + r x cross p), -r x). A weight that nobody told of adds its sag.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import StandingSpread
from doormill_ros.robot_model.gravity.sag import GravitySag
from doormill_ros.robot_model.gravity.weights import FLANGE, Weight


@dataclass(frozen=True)
class Displacement:
    """What inspected doors told of it.

    Attributes:
        shift: Of the door beside where it was seen, base axes, about the base's origin, 3 numbers [m].
        turn: About the base's x axis [rad].
        std: Standard deviation of the shift [m].
        mass: At the flange, balanced by nobody [kg].
        mass_std: Its standard deviation [kg].
        centre: Of this mass, along the flange's z [m].
    """

    shift: tuple[float, ...] = (0.0, 0.0, 0.0)
    turn: float = 0.0
    std: float = 0.0
    mass: float = 0.0
    mass_std: float = 0.0
    centre: float = 0.0

    @property
    def weight(self) -> Weight:
        """The mass on its link."""
        centre = np.array([0.0, 0.0, self.centre])
        return Weight(FLANGE, self.mass, self.mass_std, centre, np.ones(6), np.zeros(6))

    def document(self) -> dict[str, Any]:
        """As model.yaml has it."""
        return {**vars(self), "shift": list(self.shift)}


def displacement_of(document: Mapping[str, Any]) -> Displacement:
    """The section `standing` of model.yaml.

    Raises:
        KeyError, TypeError, ValueError: It is not of its form.
    """
    shift = document["shift"]
    if not isinstance(shift, list) or len(shift) != 3:
        raise ValueError(f"shift of standing is {shift!r}, allowed are 3 numbers [m]")
    rest = {name: float(document[name]) for name in ("turn", "std", "mass", "mass_std", "centre")}
    found = Displacement(tuple(float(v) for v in shift), **rest)
    for name in ("std", "mass_std"):
        if rest[name] < 0.0:
            raise ValueError(f"{name} of standing is {rest[name]}, allowed are 0 and more")
    if not np.all(np.isfinite([*found.shift, *rest.values()])):
        raise ValueError("standing has a number that is not finite, allowed are finite ones")
    return found


class StandingDisplacement:
    """A displacement as the twist of a robot's tool (implements what `SaggingModel` asks of a sag).

    Args:
        robot: Whose arm the weight bends.
        stiffness: Springs of its joints, shape (6,) [N m / rad].
        told: By the doors.
    """

    def __init__(self, robot: Robot, stiffness: FloatArray, told: Displacement) -> None:
        self._kinematics, self._told = Kinematics(robot), told
        self._sag = GravitySag(self._kinematics, stiffness, [told.weight], np.zeros((0, 6)))

    def twist(self, q: FloatArray, point: FloatArray) -> FloatArray:
        """Of the tool.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            point: The tool tip, flange frame, shape (3,) [m].

        Returns:
            Shape (n, 6) [m, rad], base axes.
        """
        T = self._kinematics.forward(q)
        place = T[:, :3, :3] @ point + T[:, :3, 3]
        turn = np.array([self._told.turn, 0.0, 0.0])
        found = self._sag.twist(q, point)
        found[:, :3] -= np.array(self._told.shift) + np.cross(turn, place)
        found[:, 3:] -= turn
        return found

    def spread(self, q: FloatArray, point: FloatArray, relative: FloatArray) -> StandingSpread:
        """How well that is known, arguments as `GravitySag.spread`."""
        sag = self._sag.spread(q, point, relative)
        return StandingSpread(sag.joints, np.hypot(sag.rest, self._told.std))
