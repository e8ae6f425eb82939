"""What a search knows of its series before it asks which causes may act in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from doormill_ros.robot_model.pose.view import SetView


def places_of_joints(count: int) -> tuple[str, ...]:
    """'joint 1' to the last."""
    return tuple(f"joint {k}" for k in range(1, count + 1))


@dataclass(frozen=True, eq=False)
class Hints:
    """Series, and what their residual has shown so far.

    Attributes:
        sets: The series.
        orders: Waves a turn to look for in a joint's own angle, by place of the joint.
        steps: First row after a step by index of the series, where one is suspected.
        drift: Whether to look for slow displacements within a series.
        scaled: Whether one share may stand for the lengths of several links.
    """

    sets: Sequence[SetView]
    orders: Mapping[str, Sequence[int]]
    steps: Mapping[int, int] = field(default_factory=dict)
    drift: bool = True
    scaled: bool = False

    @property
    def joints(self) -> tuple[str, ...]:
        """Places of the joints."""
        return places_of_joints(self.sets[0].joints)
