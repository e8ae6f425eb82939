"""What every door shows alike and nothing names: a discrepancy between model and robot that may stay unknown.

It is a Gaussian process with a covariance of the kind's own (Kennedy and O'Hagan, Bayesian calibration of computer
models, 2001): what it can make of the points counts for no cause and against none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.spatial import cKDTree

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.nuisance import Alike
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.effects.case import TOOL, CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.diagnosis.parts.effects.force import ForceScale
from doormill_ros.diagnosis.parts.effects.geometry import LinkOffsets
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.moved import by_load
from doormill_ros.frames import inverse
from doormill_ros.robot_model.elastic.places import JOINTS
from doormill_ros.statistics import root_mean_square

_SAME = 1e-3  #: points of a recipe's surface nearer than this are one [m]


@dataclass(frozen=True)
class Discrepancy:
    """One way in which every door may be off alike.

    Attributes:
        size: Root mean square of what the doors show of it [m].
        where, acts_on, driver: As `unnamed` of diagnosis.json has them.
        words: What it is like.
        hides: Which causes it may hide, in a sentence.
        test: What would tell what it is.
        generous: Its standard deviation over what the doors show: it is to leave little of that to causes.
        recurring: Doors of a recipe that have to show it, on average.
        varies: Share of it by which doors differ.
    """

    where: ClassVar[str]
    acts_on: ClassVar[str]
    driver: ClassVar[str]
    words: ClassVar[str]
    hides: ClassVar[str]
    test: ClassVar[str]
    generous: ClassVar[float] = 3.0
    recurring: ClassVar[int] = 1
    varies: ClassVar[float] = 0.0

    size: float

    def could_be(self, effect: Effect) -> bool:
        """Whether an effect of one size might be taken for it: then only its changes are told."""
        raise NotImplementedError

    def columns(self, case: CutCase) -> FloatArray:
        """What numbers of unit variance make of the points, shape (n, k) [m]."""
        return np.zeros((len(case), 0))

    def groups(self, place: FloatArray, surface: IntArray) -> IntArray | None:
        """Points that have one number in common, by the number of their group, shape (n,); None for none.

        Args:
            place: Points in the frame of their door, shape (n, 3) [m].
            surface: Number of the surface of the recipe that each lies on, shape (n,).
        """
        return None

    @property
    def spread(self) -> float:
        """Standard deviation of what it makes of a point [m]."""
        return self.generous * self.size


@dataclass(frozen=True)
class ForceDiscrepancy(Discrepancy):
    """A process force that is another one at every door, as wood is; its size is that of the nominal springs.

    Attributes:
        members: Of the model that gives way to it; none for the nominal springs.
        theta: Numbers of the model.
    """

    where = "tool"
    acts_on = "process force"
    driver = "constant"
    words = "the process force is another one at every door, by chance, which moves the walls"
    hides = "A force that is a little larger or smaller throughout would be a part of this."
    test = "the load of the spindle, door by door, tells whether the wood or the mill makes it so"
    generous = 1.0  # what is too much of it passes for a force that nobody knows

    members: tuple[InTime, ...] = ()
    theta: tuple[float, ...] = ()

    def could_be(self, effect: Effect) -> bool:
        """Nothing: chance neither begins nor stays."""
        return False

    def columns(self, case: CutCase) -> FloatArray:
        """What gives way at each door, in proportion to its force."""
        share = self.spread / max(root_mean_square(case.springs()), 1e-9)
        given = gives_way(case, self.members, np.array(self.theta))
        own: FloatArray = share * given[:, None] * (case.time[:, None] == np.unique(case.time))
        return own


def gives_way(case: CutCase, members: Sequence[InTime], theta: FloatArray) -> FloatArray:
    """What a process force twice as large moves the points more, shape (n,) [m].

    Args:
        case: The points.
        members: Of the model that gives way, gaps left out.
        theta: Its numbers, shape (p,).
    """
    force = InTime(ForceScale(TOOL))
    return by_load(case, (force, *members), np.concatenate([np.zeros(1), theta]), np.zeros(1, dtype=int))[
        :, 0
    ]


class ArmDiscrepancy(Discrepancy):
    """Links of the arm that are all somewhat off: a robot that nobody calibrated."""

    where = "links"
    acts_on = "place of the tool"
    driver = "own angle"
    words = "the tool is beside its place whether it cuts or not, by another way in every posture"
    hides = (
        "Causes that displace the tool as a whole are named only where they begin or drift: one that was always "
        "there would be a part of this."
    )
    test = "poses of the robot, measured by a tracker (a pose set), tell which links are off"

    def could_be(self, effect: Effect) -> bool:
        """What displaces the tool as a whole."""
        return effect.rigid

    def columns(self, case: CutCase) -> FloatArray:
        """Lengths and angles of all links; an angle of them moves the tool by a metre's length."""
        links = [LinkOffsets(joint.replace("joint", "link")) for joint in JOINTS]
        found = [link.columns(case) / link.values(np.ones(4), case) for link in links]
        return self.spread * np.hstack(found)


class WallDiscrepancy(Discrepancy):
    """Walls and floors that every door of a recipe has alike, whatever makes them so."""

    where = "tool"
    acts_on = "walls and floors"
    driver = "constant"
    words = "every door of a recipe has the same walls, which are not those that were asked for"
    hides = (
        "Causes are named only where they begin or drift: one that was always there would be a part of this."
    )
    test = (
        "the same feature milled without load (a second pass along the finished wall) tells whether forces make it, "
        "at half the speed whether the controller does"
    )
    recurring = 3
    varies = 0.01  # doors stand differently by up to 10 mm, an arm is longer than 1 m, and springs act by its length

    def could_be(self, effect: Effect) -> bool:
        """Anything."""
        return True

    def groups(self, place: FloatArray, surface: IntArray) -> IntArray | None:
        """Points of a recipe that are measured on every door of it."""
        group = np.full(len(place), -1)
        for number in np.unique(surface):
            rows = np.flatnonzero(surface == number)
            for i, near in zip(rows, cKDTree(place[rows]).query_ball_point(place[rows], _SAME), strict=True):
                if group[i] < 0:
                    fellows = rows[near]
                    group[fellows[group[fellows] < 0]] = i
        return np.unique(group, return_inverse=True)[1].ravel()


def recurring(doors: Sequence[GaugedDoor], door: IntArray, points: CutPoints) -> tuple[FloatArray, IntArray]:
    """Points in the frame of their door, shape (n, 3) [m], and the number of the recipe's surface of each, shape (n,).

    Args:
        doors: All of them.
        door: Number of the door of each point, shape (n,).
        points: Of all doors.
    """
    recipes = np.array([one.recipe for one in doors])[door]
    wall = np.where(points.wall, " wall", " floor")
    labels = np.char.add(np.char.add(np.char.add(recipes, " "), points.feature), wall)
    T_door_base = np.array([inverse(one.T_base_door) for one in doors])[door]
    place = np.einsum("nij,nj->ni", T_door_base[:, :3, :3], points.point) + T_door_base[:, :3, 3]
    return place, np.unique(labels, return_inverse=True)[1].ravel()


def made_by(
    discrepancies: Sequence[Discrepancy],
    case: CutCase,
    doors: Sequence[GaugedDoor],
    door: IntArray,
    points: CutPoints,
    noise: FloatArray,
) -> tuple[FloatArray, Alike | None]:
    """What discrepancies make of points by numbers of unit variance, whitened.

    Args:
        discrepancies: Any, of which one at most has groups.
        case: The points.
        doors: All of them.
        door: Number of the door of each point, shape (n,).
        points: Of all doors.
        noise: Standard deviation of each point, shape (n,) [m].

    Returns:
        Columns of shape (n, k), and what groups of points have in common, None for nothing.
    """
    columns, alike = [np.zeros((len(case), 0))], None
    for discrepancy in discrepancies:
        columns.append(discrepancy.columns(case))
        groups = discrepancy.groups(*recurring(doors, door, points))
        if groups is not None:
            alike = Alike(groups, discrepancy.spread / noise)
    return np.hstack(columns) / noise[:, None], alike


#: What doors that leave more than noise are asked beside, in this order: what asks less of them first.
DISCREPANCIES: Sequence[type[Discrepancy]] = (ArmDiscrepancy, WallDiscrepancy)
