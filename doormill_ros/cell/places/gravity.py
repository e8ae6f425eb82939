"""What the cell tells of weight: the load at the flange, and at which postures its places were taught."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import StrictBool

from doormill_ros.robot.description import Joints
from doormill_ros.values import Name, NotNegative, Positive, Section, Vector3


@dataclass(frozen=True, eq=False)
class ToolLoad(Section):
    """Spindle, mill and whatever else hangs on the flange.

    Attributes:
        mass: Of all of it [kg].
        std: Standard deviation of the mass, with what its centre leaves to chance [kg].
        centre: Centre of mass, flange frame, shape (3,) [m].
        source: Where the figures come from.
        measured: Whether somebody weighed it.
    """

    mass: Positive
    std: NotNegative
    centre: Vector3
    source: Name
    measured: StrictBool


@dataclass(frozen=True, eq=False)
class Gravity(Section):
    """Whose weight moves the targets, and what of it is in the cell's places already.

    Attributes:
        tool_load: At the flange; None where nobody told it, or the controller takes it up.
        links: Whether the weight of the robot's links counts; not where the controller takes it up.
        taught: Postures at which the tool tip was taken to the known points from which camera and door have their
            places, each shape (6,) [rad]; none where these were measured without the robot.
    """

    tool_load: ToolLoad | None = None
    links: StrictBool = False
    taught: tuple[Joints, ...] = ()
