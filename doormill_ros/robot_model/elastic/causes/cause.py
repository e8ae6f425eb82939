"""What every cause in the library has to say about itself."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.load_case import LoadCase


@dataclass(frozen=True)
class Parameter:
    """One reported number (or vector) of a cause.

    Attributes:
        name: Key in the diagnosis.
        unit: SI unit.
        low, high: Plausible range of each component.
        size: Number of components.
    """

    name: str
    unit: str
    low: float
    high: float
    size: int = 1


@dataclass
class Setup:
    """What causes before the elasticity change: posture, wrench and reflectors.

    Attributes:
        joint_offset: Added to the commanded angles, shape (6,) [rad].
        wrench_angle: Added to the stated sensor rotation [rad].
        wrench_gain: Factor on the recorded wrench.
        reflector_offset: Added to the position of a reflector, by name, shape (3,) [m].
    """

    joint_offset: FloatArray = field(default_factory=lambda: np.zeros(6))
    wrench_angle: float = 0.0
    wrench_gain: float = 1.0
    reflector_offset: dict[str, FloatArray] = field(default_factory=dict)


class Cause:
    """One way in which reality can differ from linear joint springs.

    Numbers that are fitted ("theta") are scaled so that the effect is near linear in them and
    zero means no effect. A cause acts in one of three ways: on the `Setup` (posture, wrench,
    reflector), as an extra `twist` of the robot, or on what the tracker reports (`observe`).

    Attributes:
        name: Fixed name of the cause.
        where: Place.
        parameters: What is reported.
        scale: Size of a typical effect in theta, shape (p,).
        lower, upper: Allowed theta, shape (p,).
        stage: "setup", "robot" or "tracker".
        of_robot: Whether it is in the robot; one in the measuring chain changes nothing for who mills with it.
        named: Whether a diagnosis may name it; patterns that only warn of the unknown are not.
        generalises: Name of the cause at the same place that this one contains as a special case.
        variant: Tells apart two readings of the same cause.
        kinked: Indices of theta in which the cost is not smooth; their uncertainty is profiled.
    """

    name: str = ""
    where: str = ""
    parameters: tuple[Parameter, ...] = ()
    scale: FloatArray
    lower: FloatArray
    upper: FloatArray
    stage: str = "robot"
    of_robot: bool = True
    named: bool = True
    generalises: str = ""
    variant: str = ""
    kinked: tuple[int, ...] = ()

    def __init__(self, where: str) -> None:
        """Put the cause at its place."""
        self.where = where

    def __repr__(self) -> str:
        return f"{self.name} at {self.where}" + (f" ({self.variant})" if self.variant else "")

    @property
    def key(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.where

    @property
    def identity(self) -> tuple[str, str, str]:
        """Name, place and variant."""
        return self.name, self.where, self.variant

    @property
    def size(self) -> int:
        """Number of fitted numbers."""
        return len(self.scale)

    def pattern(self) -> str:
        """One sentence: what the cause leaves in the data."""
        raise NotImplementedError

    def starts(self, case: LoadCase) -> list[FloatArray]:
        """Values of theta, shape (p,), from which a fit may start."""
        return [np.zeros(self.size)]

    def setup(self, setup: Setup, theta: FloatArray) -> None:
        """Change what comes before the elasticity, by theta, shape (p,)."""

    def twist(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Extra displacement of the points and rotation, base axes, shape (n, 6) [m, rad]."""
        raise NotImplementedError

    def derivative(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Derivative of `twist` by theta, shape (n, 6, p)."""
        raise NotImplementedError

    def observe(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """What the tracker reports of true displacements (n, 3) [m]."""
        return displacement

    def observe_derivative(self, displacement: FloatArray, dt: FloatArray, theta: FloatArray) -> FloatArray:
        """Derivative of `observe` by theta, shape (n, 3, p)."""
        raise NotImplementedError

    def hidden_state(self, case: LoadCase) -> FloatArray | None:
        """Probability that the cause acts in each trial, shape (n,); None when that is always certain."""
        return None

    def hidden_sign(self, case: LoadCase) -> FloatArray | None:
        """Log odds that `twist` has the right sign in each trial, shape (n,), inf where sure; None when always."""
        return None

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Reported values of all parameters in a row, shape (v,), of theta, shape (p,)."""
        raise NotImplementedError

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """Theta, shape (p,), of reported values, the inverse of `values`."""
        raise NotImplementedError


class LinearTwist(Cause):
    """A cause whose twist is a fixed pattern times theta."""

    def unit(self, case: LoadCase) -> FloatArray:
        """Twist for theta = 1, shape (n, 6, p)."""
        raise NotImplementedError

    def derivative(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """The pattern, computed once for each load case."""
        if self.identity not in case.cache:
            case.cache[self.identity] = self.unit(case)
        return case.cache[self.identity]

    def twist(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """Pattern times theta."""
        return self.derivative(case, theta) @ theta


def number(where: str) -> int:
    """Zero-based number of 'joint 3' or 'link 3'."""
    return int(where.split()[1]) - 1
