"""Robot, spindle, mill, door and cell as bodies, and the distances between those that must not touch.

Kinematics and distances are those of Pinocchio and coal: one posture a call, every pair of bodies that is asked for.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

try:
    import coal
except ImportError:  # its name until Pinocchio 3
    import hppfcl as coal

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.collision.placed import Placed
from doormill_ros.collision.separation import Bodies, Region, curve_of
from doormill_ros.collision.skeleton import Skeleton, model_of, skeleton_of
from doormill_ros.robot.bodies import Body, load_bodies
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot

DOOR, MILL = "door", "mill"
MANY = 60  #: pairs of which it is quicker to ask for all than for each
FEW = 12  #: pairs of which it is quicker to tell the gap at once than roughly first
_BEHIND = np.arange(1, JOINTS + 1)  #: numbers of the joints, of which the base is 0
#: Bodies fewer joints apart than this are held apart by the joints' limits.
JOINTS_APART = 3
FAR = 0.05  #: pairs that cannot come this close beside the clearance are left out [m]
#: The limits of axis 5 hold a bare flange off the forearm. What hangs on it is held against those of the forearm's
#: bodies that do not come this close to the wrist centre [m].
FOREARM, WRIST_ROOM = 4, 0.25
#: A mill of at most this radius is a capsule, which goes by as much beyond the tip. A wider one is a box about it:
#: it would not get near the face [m].
SLIM = 0.0125


@dataclass(frozen=True)
class Mill:
    """The mill as far as it reaches out of the spindle, and half its width [m]."""

    reach: float
    radius: float


@dataclass(frozen=True, eq=False)
class PlacedDoor:
    """A door as a box: extent along x, y, z of its frame, shape (3,) [m], and T_base_door, shape (4, 4)."""

    size: FloatArray
    T_base_door: FloatArray


class World:
    """One robot before one door.

    Attributes:
        names: The two bodies of every pair that can meet at all, the moving one first.
        reach: How far the farthest point of a pair's moving body can be from each axis that moves the two
            against each other, 0 for the others, shape (pairs, 6) [m].
        farthest: The largest of that, shape (6,) [m].
        outside_cut: Pairs that must stay apart even while the mill is in the wood, shape (pairs,): there the tool
            meets the door and what backs it, and the spindle keeps off its surface by the depth of the feature alone.
        tool_and_cell: Pairs of spindle or mill and something that stands still, shape (pairs,).
        clearance: What every pair must keep [m].
    """

    def __init__(self, robot: Robot, layout: CellLayout, mill: Mill, door: PlacedDoor | None) -> None:
        """Take the bodies of the robot's and the cell's files, the mill at the tool centre point, and a door."""
        self.clearance = layout.clearance
        self._model = model_of(robot.urdf)
        self._data = self._model.createData()
        self._geometry = pin.GeometryModel()
        self._bones = skeleton_of(robot.urdf)
        self._index: dict[Placed, int] = {}  # its bodies in turn, with their numbers
        moving = [self._add(body, body.link) for body in load_bodies(robot)]
        spindle = [self._add(body, robot.flange_link) for body in layout.spindle]
        mill_body = self._add(_mill_body(layout, mill), robot.flange_link)
        fixed = [self._add(body, self._model.frames[1].name) for body in layout.obstacles]
        if door is not None:
            boards = [(board.name, board.box(door.size)) for board in layout.boards]
            fixed += [self._add_box(name, *box, door.T_base_door) for name, box in boards if box is not None]
            fixed.append(self._add_box(DOOR, np.zeros(3), door.size, door.T_base_door))
        moving += [*spindle, mill_body]
        # What a body reaches in no posture is no pair: of most of the cell the better part of the arm.
        away = [body.away - self.clearance - FAR for body in fixed]
        pairs = [
            (a, b) for a in moving if a.joint for b, off in zip(fixed, away, strict=True) if off < a.farthest
        ]
        tool = {body.name for body in [*spindle, mill_body]}
        wrist = self._model.jointPlacements[FOREARM + 1].translation
        forearm = [body for body in moving if body.joint == FOREARM and body.distance_to(wrist) >= WRIST_ROOM]
        pairs += [(a, b) for a in moving for b in moving if a.joint - b.joint >= JOINTS_APART]
        pairs += [(a, b) for a in [*spindle, mill_body] for b in forearm]
        self._sides = np.array([(self._index[a], self._index[b]) for a, b in pairs]).T
        for first, second in self._sides.T.tolist():
            self._geometry.addCollisionPair(pin.CollisionPair(first, second))
        self._results = self._geometry.createData()
        # Each stays where it is and is filled anew; to take them out of Pinocchio costs as much as the distances.
        self._found = list(self._results.distanceResults)
        self.names = tuple((a.name, b.name) for a, b in pairs)
        moves = np.array([b.joint for a, b in pairs])[:, None] < _BEHIND
        self.reach = np.where(moves, np.array([a.reach for a, b in pairs]), 0.0)
        self.farthest: FloatArray = self.reach.max(axis=0, initial=0.0)
        self._curve = curve_of(self.reach)
        self._most_curved = curve_of(self.farthest[None])[0]
        self._joint_behind = np.array([b.joint for a, b in pairs])
        self._joints = [self._data.oMi[i] for i in range(JOINTS + 1)]
        self._bodies = Bodies(
            np.array([body.half for body in self._index]),
            np.array([body.margin for body in self._index]),
            np.array([body.joint for body in self._index]),
            np.array([body.place for body in self._index]),
        )
        still = {body.name for body in fixed}
        self.tool_and_cell: BoolArray = np.array([a.name in tool and b.name in still for a, b in pairs])
        cut = {DOOR, *(board.name for board in layout.boards)}
        self.outside_cut: BoolArray = np.array([not (a.name in tool and b.name in cut) for a, b in pairs])

    def distances(self, q: FloatArray, pairs: IntArray | None = None) -> FloatArray:
        """Distance of each pair in one posture, negative where two overlap [m].

        Args:
            q: The posture, shape (6,) [rad].
            pairs: Numbers of the pairs, shape (n,); None for all of them.

        Returns:
            Shape (n,).
        """
        if pairs is None or len(pairs) > MANY:
            nearest = pin.computeDistances(self._model, self._data, self._geometry, self._results, q)
            found = np.array([result.min_distance for result in self._found])
            if len(found) and found[nearest] != self._results.distanceResults[nearest].min_distance:
                raise AssertionError("Pinocchio has put its distances elsewhere")
            return found if pairs is None else found[pairs]
        pin.updateGeometryPlacements(self._model, self._data, self._geometry, self._results, q)
        return np.array(
            [pin.computeDistance(self._geometry, self._results, i).min_distance for i in pairs.tolist()]
        )

    def region(self, q: FloatArray, hulls: IntArray, off: FloatArray | None = None) -> Region:
        """Postures in the hulls of some.

        Args:
            q: Some postures, shape (n, 6) [rad].
            hulls: Numbers of those that each hull is of, shape (h, c).
            off: How far each joint may be beside a hull, shape (h, 6) [rad]; None for not at all.
        """
        return Region(
            q, hulls, np.zeros((len(hulls), JOINTS)) if off is None else off, self._bones, self._bodies
        )

    def bend(self, turn: FloatArray) -> FloatArray:
        """How far any body may be off its chord while joints turn by so much, shapes (n, 6) [rad] -> (n,) [m]."""
        both = (turn[:, :, None] * turn[:, None, :]).reshape(len(turn), -1)
        bend: FloatArray = 0.125 * both @ self._most_curved
        return bend

    def lowest(
        self,
        pairs: IntArray,
        distance: FloatArray,
        here: FloatArray,
        region: Region,
        enough: float = np.inf,
    ) -> FloatArray:
        """Distances that pairs have at least in a region, shape (n, h) [m].

        Most bodies are so far apart that their reach alone tells enough; a plane is looked for only between others.

        Args:
            pairs: Their numbers, shape (n,).
            distance: What was found when they were asked for last, all above 0, shape (n,) [m].
            here: The posture in which that was, shape (6,) [rad].
            region: The postures, in h hulls.
            enough: For a pair that keeps this in every hull something less than its bound may be told, yet no less
                than this [m].
        """
        reach = self.reach[pairs]
        lowest: FloatArray = distance[:, None] - reach @ (region.turned(here) + region.off).T
        near = np.flatnonzero(lowest.min(axis=1) < enough)
        normal = self._planes(pairs[near]) if len(near) else np.empty((0, 3))
        ways = (self._bodies.rough_gap, self._bodies.gap)
        for gap_along in ways if len(near) > FEW else ways[1:]:
            if not len(near):
                break
            # The library knows a plane less exactly than a distance, which tells on bodies as wide as a floor.
            rows = pairs[near]
            gap = gap_along(self._sides[:, rows], normal, region)
            over_hull = np.minimum.reduce([gap[:, corner] for corner in region.hulls.T])
            by_plane = over_hull - 0.125 * self._curve[rows] @ region.spread
            lowest[near] = np.maximum(by_plane - reach[near] @ region.off.T, lowest[near])
            unproven = lowest[near].min(axis=1) < enough
            near, normal = near[unproven], normal[unproven]
        return lowest

    def _planes(self, pairs: IntArray) -> FloatArray:
        """Normals of planes between pairs in the posture in which their distances were asked for last, shape (n, 3).

        Each in the frame of the joint of the pair's second body, towards the first one.
        """
        results = [self._found[i] for i in pairs.tolist()]
        first = np.concatenate([result.getNearestPoint1() for result in results])
        second = np.concatenate([result.getNearestPoint2() for result in results])
        way = (first - second).reshape(-1, 3)
        R_base_joint = np.array([place.rotation for place in self._joints])[self._joint_behind[pairs]]
        normal: FloatArray = (way[:, None] @ R_base_joint)[:, 0]
        normal /= np.sqrt((normal**2).sum(axis=1))[:, None]
        return normal

    def _add(self, body: Body, link: str) -> Placed:
        return self._put(*_on_joint(self._model, self._bones, body, link))

    def _add_box(self, name: str, low: FloatArray, high: FloatArray, T_base_door: FloatArray) -> Placed:
        """A box between two corners of the door frame."""
        T = T_base_door.copy()
        T[:3, 3] += T[:3, :3] @ (0.5 * (low + high))
        box = Placed(name, 0, np.zeros((0, 3)), 0.0, 0.5 * (high - low), T, self._bones)
        return self._put(box, coal.Box(*(high - low)))

    def _put(self, body: Placed, shape: coal.CollisionGeometry) -> Placed:
        place = pin.SE3(body.place)
        if coal.__name__ == "coal":
            own = pin.GeometryObject(body.name, body.joint, place, shape)
        else:
            own = pin.GeometryObject(body.name, body.joint, shape, place)
        self._index[body] = int(self._geometry.addGeometryObject(own))
        return body


@functools.lru_cache(maxsize=256)  # but for the door all bodies stay what they are
def _on_joint(
    model: pin.Model, bones: Skeleton, body: Body, link: str
) -> tuple[Placed, coal.CollisionGeometry]:
    """A body of a link on its joint, and its shape."""
    frame = model.frames[model.getFrameId(link)]
    T_joint_link = frame.placement.homogeneous
    if body.size is not None:
        shape, half = coal.Box(*body.size), 0.5 * body.size
    else:
        length = float(np.linalg.norm(np.subtract(*body.ends)))
        shape, half = coal.Capsule(body.margin, length), np.array([0.0, 0.0, 0.5 * length])
    corners = body.corners @ T_joint_link[:3, :3].T + T_joint_link[:3, 3]
    joint, place = int(frame.parentJoint), T_joint_link @ body.T_frame_body
    return Placed(body.name, joint, corners, body.margin, half, place, bones), shape


@functools.lru_cache(maxsize=8)  # it is made for every door, and what it works out of itself stays with it
def _mill_body(layout: CellLayout, mill: Mill) -> Body:
    if mill.radius > SLIM:
        size = np.array([2.0 * mill.radius, 2.0 * mill.radius, mill.reach])
        middle = np.array([0.0, 0.0, -0.5 * mill.reach])
        body = Body(name=MILL, shape="box", size=size, position=middle, rotation=np.zeros(3))
        return body.mapped(layout.T_flange_tool)
    tip = layout.T_flange_tool[:3, 3]
    back = tip - mill.reach * layout.T_flange_tool[:3, 2]
    return Body(name=MILL, shape="capsule", radius=mill.radius, start=back, end=tip)
