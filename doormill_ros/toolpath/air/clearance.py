"""See that nothing of the robot touches the door, the clamp or the cell: in the air, and while it mills."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.collision.sweep import RESERVE, Contact, contact_along, contact_on_line
from doormill_ros.collision.world import World
from doormill_ros.recipes.features.base import Feature
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.toolpath.air.reach import JointPath
from doormill_ros.toolpath.curves.plain_vectors import plain_cross
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.errors import AirMoveError, BodyContactError, HolderError, ReachError
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import Approach
from doormill_ros.units import m_to_mm

OUTLINE_ERROR = 1e-3  #: of the polygon whose extent is that of a feature [m]
SMALLEST_CELL = 1e-4  #: parts of a feature's space are not divided further [m]
#: Lowest and highest place, postures of shape (9, 6), and the numbers of the pairs that are not proven in all of it.
_Cell = tuple[FloatArray, FloatArray, FloatArray, IntArray]
_CORNERS = np.array(np.meshgrid(*[[0.0, 1.0]] * 3)).reshape(3, -1).T  # (8, 3)


def check_holder(operations: Sequence[Operation], approach: Approach, clearance: float) -> None:
    """See that the spindle does not meet the surface over a deep pocket.

    Args:
        operations: What the robot mills.
        approach: Where the spindle begins.
        clearance: How far it keeps off [m].

    Raises:
        HolderError: A feature is deeper than the mill reaches out of the spindle.
    """
    allowed = approach.nose - clearance
    for item in operations:
        if item.depth > allowed:
            raise HolderError(
                f"{item.feature.id}: it is {m_to_mm(item.depth):.1f} mm deep, allowed are {m_to_mm(allowed):.1f} "
                f"mm, where the spindle is {m_to_mm(clearance):.0f} mm off the surface; mill it from both sides, "
                "or measure approach.nose again",
                feature=item.feature.id,
                found=item.depth,
                allowed=allowed,
            )


def between_features(steps: Sequence[Step], index: int) -> bool:
    """True for the step that alone leads from one feature to the next, joint by joint."""
    step = steps[index]
    return (
        step.kind is MotionKind.ABSOLUTE
        and not step.feature
        and 0 < index < len(steps) - 1
        and bool(steps[index - 1].feature and steps[index + 1].feature)
    )


def check_air(steps: Sequence[Step], path: JointPath, world: World) -> None:
    """See that nothing is touched on a motion between features.

    The way to the first feature is planned from home, and a single MoveAbsJ from feature to feature gets points to
    pass: both are not looked at here.

    Args:
        steps: The plan.
        path: Joint angles along it.
        world: Robot, door and cell.

    Raises:
        AirMoveError: A motion comes too close.
    """
    free = 0  # motions up to this one are free
    for i in range(1, len(steps)):
        if i <= free or not _alone_in_air(steps, i):
            continue
        if steps[i].kind is MotionKind.ABSOLUTE:
            last = _last_of_swing(steps, i)
            found = contact_along(world, path.stations[i - 1 : last + 1, -1])
            if found is None:
                free = last
            elif last > i:  # whichever of them it is on
                found = contact_along(world, path.stations[[i - 1, i], -1])
        else:
            rows = path.step == i
            found = contact_on_line(world, path.q[rows], path.fraction[rows])
        if found is not None:
            feature = next((s.feature for s in steps[i:] if s.feature), "")
            raise AirMoveError(
                f"{feature}, motion {i + 1} of {len(steps)}: on the way there {meeting(found, world)}; choose another "
                "approach in config/toolpath.yaml, another place of the robot or a shorter tool",
                feature=feature,
                motion=i + 1,
                **facts(found, world),
            )


def _alone_in_air(steps: Sequence[Step], index: int) -> bool:
    """True for what `check_air` looks at."""
    return _in_air(steps, index) and not between_features(steps, index)


def _last_of_swing(steps: Sequence[Step], index: int) -> int:
    """Number of the last MoveAbsJ of those one after the other: all together are looked at in half the time of each."""
    last = index
    while (
        last + 1 < len(steps)
        and steps[last + 1].kind is MotionKind.ABSOLUTE
        and _alone_in_air(steps, last + 1)
    ):
        last += 1
    return last


def _in_air(steps: Sequence[Step], index: int) -> bool:
    """True where the mill is nowhere near its own feature: it goes in and comes out straight along the tool."""
    step = steps[index]
    if step.cutting:
        return False
    if not step.feature:
        return True
    way = (step.curve.end - step.curve.start).tolist()
    return math.hypot(*plain_cross(way, step.R_door_tool[:, 2].tolist())) > 1e-6


def check_feature(
    item: Operation,
    front: FloatArray,
    q: FloatArray,
    T_base_door: FloatArray,
    T_tool_flange: FloatArray,
    robot: Robot,
    world: World,
) -> None:
    """See that the arm touches nothing wherever the tool is in a feature, in front of it and on the way straight out.

    The tool's places fill a box from in front of the surface to the depth of the feature. Each posture proves a
    neighbourhood in joint space; the box is divided until each part lies within one.

    Args:
        item: The feature.
        front: Where the tool waits in front of it, door frame, shape (3,) [m].
        q: Joint angles there, shape (6,) [rad].
        T_base_door: Where the door stands, shape (4, 4).
        T_tool_flange: The flange in the tool frame, shape (4, 4).
        robot: Who mills.
        world: Robot, door and cell.

    Raises:
        BodyContactError: The arm comes too close to something.
        ReachError: A place in the box is out of reach.
    """
    R, p = item.T_door_feature[:3, :3], item.T_door_feature[:3, 3]
    least, most = _extent(item.feature)
    low = np.array([*least, float((front - p) @ R[:, 2])])
    high = np.array([*most, item.depth])
    R_base_flange = T_base_door[:3, :3] @ item.R_door_tool @ T_tool_flange[:3, :3]
    arm = T_base_door[:3, :3] @ item.R_door_tool @ T_tool_flange[:3, 3]

    def with_postures(pairs: IntArray, *parts: tuple[FloatArray, FloatArray]) -> list[_Cell]:
        """Parts of the box with the postures at their corners and in their middle, solved in one go."""
        boxes = [
            np.concatenate([low + _CORNERS * (high - low), 0.5 * (low + high)[None]]) for low, high in parts
        ]
        places = np.concatenate(boxes)
        poses = np.tile(np.eye(4), (len(places), 1, 1))
        poses[:, :3, :3] = R_base_flange
        poses[:, :3, 3] = ((places @ R.T) + p) @ T_base_door[:3, :3].T + T_base_door[:3, 3] + arm
        postures = inverse_near(robot, poses, q).reshape(len(parts), -1, 6)
        return [(*part, own, pairs) for part, own in zip(parts, postures, strict=True)]

    cells = with_postures(np.flatnonzero(world.outside_cut), (low, high))
    while cells:
        low, high, postures, pairs = cells.pop()
        if np.isnan(postures).any():
            raise ReachError(
                f"{item.feature.id}: {robot.label} cannot draw the tool straight out of it everywhere; move the "
                "work or the robot",
                feature=item.feature.id,
            )
        here = postures[-1]
        distance = world.distances(here, pairs)
        worst = int(distance.argmin())
        small = float((high - low).max()) < SMALLEST_CELL
        if distance[worst] < world.clearance + RESERVE or small:
            body, obstacle = world.names[pairs[worst]]
            found = Contact(body, obstacle, float(distance[worst]), here)
            raise BodyContactError(
                f"{item.feature.id}: with the tool in it {meeting(found, world)}; place the robot differently, "
                "use a longer tool or leave the feature to the second robot",
                feature=item.feature.id,
                **facts(found, world),
            )
        bulge = 2.0 * np.abs(postures[:-1].mean(axis=0) - here)
        enough = world.clearance + RESERVE
        region = world.region(postures[:-1], np.arange(8)[None], bulge[None])
        lowest = world.lowest(pairs, distance, here, region, enough)[:, 0]
        if lowest.min() < world.clearance:
            axis = int((high - low).argmax())
            middle = 0.5 * (low[axis] + high[axis])
            first, second = high.copy(), low.copy()
            first[axis] = second[axis] = middle
            cells += with_postures(pairs[lowest < enough], (low, first), (second, high))


@functools.lru_cache(maxsize=128)  # asked for with every pose of a door
def _extent(feature: Feature) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest places of the tool's centre in a feature's plane, shape (2,) each [m]."""
    outline = feature.outline(feature.tool.radius).points(step=np.inf, chord_error=OUTLINE_ERROR)
    return outline.min(axis=0) - OUTLINE_ERROR, outline.max(axis=0) + OUTLINE_ERROR


def meeting(found: Contact, world: World) -> str:
    """What comes too close, by how much, and what is allowed."""
    how = (
        f"pass at {m_to_mm(found.distance):.0f} mm"
        if found.distance >= 0.0
        else f"overlap by {m_to_mm(-found.distance):.0f} mm"
    )
    allowed = m_to_mm(world.clearance + RESERVE)
    return f"{found.what} {how}, allowed are {allowed:.0f} mm apart"


def facts(found: Contact, world: World) -> dict[str, str | float]:
    """The same for a program that reads the error."""
    return {
        "body": found.body,
        "obstacle": found.obstacle,
        "found": found.distance,
        "allowed": world.clearance + RESERVE,
    }
