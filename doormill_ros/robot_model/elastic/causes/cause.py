"""What every cause in the library has to say about itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Candidate, number
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.elastic.places import JOINTS

#: What drives a cause.
CONSTANT, OWN_TORQUE, DIRECTION, WRENCH, TIME = (
    "constant",
    "own torque",
    "direction",
    "wrench",
    "time under load",
)
#: What shows most causes in a joint without any other loading of the robot.
ALONE = "load the joint alone, with small and large weights and from both sides"


@dataclass
class Setup:
    """What causes before the elasticity change: posture, wrench and reflectors.

    Attributes:
        joint_offset: Added to the commanded angles, shape (6,) [rad].
        wrench_angle: Added to the stated sensor rotation [rad].
        wrench_gain: Factor on the recorded wrench.
        process_angle: Turn of the process wrench about the tool [rad].
        reflector_offset: Added to the position of a reflector, by name, shape (3,) [m].
    """

    joint_offset: FloatArray = field(default_factory=lambda: np.zeros(6))
    wrench_angle: float = 0.0
    wrench_gain: float = 1.0
    process_angle: float = 0.0
    reflector_offset: dict[str, FloatArray] = field(default_factory=dict)


class ElasticCause(Candidate[LoadCase]):
    """One way in which reality can differ from linear joint springs.

    It acts in one of three ways: on the `Setup` (posture, wrench, reflector), as an extra `twist` of the robot, or
    on what the tracker reports (`observe`).

    Attributes:
        places: Where it may act; None for every reflector.
        variants: Readings of it.
        stage: "setup", "robot" or "tracker".
        driver: What its size goes with from trial to trial.
        added_last: Of the tracker's, whether it is added to what is reported when all others have acted.
        scales_all: Whether it changes all displacements by one share, as springs would that change alike.
        direct: What shows it where no loading of the whole robot does, as an order.
    """

    places: tuple[str, ...] | None = JOINTS
    variants: tuple[str, ...] = ("",)
    stage: str = "robot"
    driver: str = CONSTANT
    added_last: bool = False
    scales_all: bool = False
    direct: str = ""

    @classmethod
    def candidates(cls, reflectors: Iterable[str]) -> Sequence[ElasticCause]:
        """Every variant at every place, for a test with these reflectors."""
        places = reflectors if cls.places is None else cls.places
        return [cls.build(where, variant) for where in places for variant in cls.variants]

    @classmethod
    def build(cls, where: str, variant: str) -> ElasticCause:
        """A variant at a place."""
        return cls(where)

    @property
    def also_at(self) -> tuple[str, ...]:
        """Other places at which a law may act of which this cause is the mean."""
        return ()

    def kinks(self, case: LoadCase) -> FloatArray:
        """Of a torque limit, as a share of the largest torque of the joint: they lie at the torques of the trials."""
        k = index(self.where)
        share: FloatArray = np.abs(case.torque[:, k]) / case.largest_torque[k]
        return share

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

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """Theta, shape (p,), of reported values, the inverse of `values`."""
        raise NotImplementedError


class LinearTwist(ElasticCause):
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


def index(where: str) -> int:
    """Index of 'joint 3' or 'link 3' in an array over joints or links 1 ... 6."""
    return number(where) - 1
