"""What a search knows of its series before it asks which causes may act in them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.view import SetView


def places_of_joints(count: int) -> tuple[str, ...]:
    """'joint 1' to the last."""
    return tuple(f"joint {k}" for k in range(1, count + 1))


@dataclass(frozen=True)
class TimeCourse:
    """How something grows while a series is recorded: from 0 at its start to 1 at its end.

    Attributes:
        decay: Time constant as a share of the series; infinite for what grows steadily.
        spread: Its standard deviation as a share of it.
    """

    decay: float
    spread: float = 0.0

    def grown(self, elapsed: FloatArray) -> FloatArray:
        """Share of what it comes to, by elapsed shares of the series, shape (n,)."""
        if not np.isfinite(self.decay):
            return elapsed
        grown: FloatArray = np.expm1(-elapsed / self.decay) / np.expm1(-1.0 / self.decay)
        return grown


@dataclass(frozen=True, eq=False)
class Hints:
    """Series, and what their residual has shown so far.

    Attributes:
        sets: The series.
        orders: Waves a turn to look for in a joint's own angle, by place of the joint.
        steps: First row after a step, and to how many rows it is known, by index of the series where one is suspected.
        courses: How the base settles by index of the series, where it is suspected to.
        drift: Whether to look for slow displacements within a series.
        known: Series in which steps and courses say all there is: no other displacement is looked for.
        scaled: Whether one share may stand for the lengths of several links.
    """

    sets: Sequence[SetView]
    orders: Mapping[str, Sequence[int]]
    steps: Mapping[int, tuple[int, int]] = field(default_factory=dict)
    courses: Mapping[int, TimeCourse] = field(default_factory=dict)
    drift: bool = True
    known: Collection[int] = ()
    scaled: bool = False

    @property
    def joints(self) -> tuple[str, ...]:
        """Places of the joints."""
        return places_of_joints(self.sets[0].joints)
