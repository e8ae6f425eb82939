"""Size, side, material and mass of a door, and what the cell takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.recipes.quantities import Choice


@dataclass(frozen=True)
class DoorSize:
    """Extents of a door along z, y and x of the door frame: height, width, thickness [m].

    Attributes:
        height, width, thickness: Extents [m].
        head_down: True for a door that stands on its head in the clamp.
    """

    height: float
    width: float
    thickness: float
    head_down: bool = False


# Thesis sections 1.3 and 3.7 disagree on the lower limits; the wider ones are taken.
HEIGHT_MM = (1000.0, 3000.0)
WIDTH_MM = (190.0, 1350.0)
THICKNESS_MM = (30.0, 100.0)
MASS_KG = (0.5, 125.0)  # appendix A.1 gives the upper limit
DENSITY = (60.0, 1400.0)  #: kg/m^3 of a whole door, from a honeycomb core to the densest wood


class HingeSide(str, Choice):
    """Where the hinges are, seen from the side to which the door opens.

    The clamp holds every door by its hinge edge, y = 0 of the door frame, with the side it opens to
    before the robot. A right-hung door stands upright there, a left-hung door on its head.
    """

    LEFT = "left"
    RIGHT = "right"


class Material(str, Choice):
    """What the door is made of."""

    SOFTWOOD = "softwood"
    HARDWOOD = "hardwood"
    PLYWOOD = "plywood"
    CHIPBOARD = "chipboard"
    MDF = "mdf"
    HONEYCOMB = "honeycomb"  #: two skins on a paper core, or tubular chipboard


class Side(str, Choice):
    """Surface of the door that a feature is milled into."""

    FRONT = "front"
    REAR = "rear"
    HINGE_EDGE = "hinge_edge"
    LOCK_EDGE = "lock_edge"

    @property
    def is_edge(self) -> bool:
        """True for the two edges."""
        return self in (Side.HINGE_EDGE, Side.LOCK_EDGE)


# Columns: x, y, z of the feature frame in door axes; y is up and z goes into the wood.
R_DOOR_FEATURE = {
    Side.FRONT: np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    Side.REAR: np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    Side.HINGE_EDGE: np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]),
    Side.LOCK_EDGE: np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
}

#: Tool axes in feature axes while the feature is milled: x along -y of the feature, z into the wood.
#: On the front of a door in its nominal place this is the flange orientation of the robot's home pose.
R_FEATURE_TOOL = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
