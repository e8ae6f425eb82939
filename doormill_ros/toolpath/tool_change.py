"""Tool changes between the parts of a program: ways to the rack and back, and what is done there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.cell.rack import Rack
from doormill_ros.collision.joint_way import joint_way
from doormill_ros.collision.sweep import Contact, bulge_of, contact_along
from doormill_ros.collision.world import World
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.assemble import MOST_POINTS
from doormill_ros.toolpath.clearance import facts, meeting
from doormill_ros.toolpath.errors import NoWayError, ProgramSizeError
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.settings import PathSettings

SEAT_SAMPLES = 21  #: postures between the front of a place and its seat


class RackWays:
    """Motions from home through the rack and home again, checked once for each pair of places.

    Args:
        world: Robot, cell and door, with a mill in the spindle: the ways hold for an empty one as well.
        robot: Whose joints.
        layout: Home, tool and rack.
        settings: Speeds and margins.
    """

    def __init__(self, world: World, robot: Robot, layout: CellLayout, settings: PathSettings) -> None:
        if layout.rack is None:
            raise ValueError("the cell has no rack, allowed is one with places")
        self.rack: Rack = layout.rack
        self.world, self.robot, self.layout = world, robot, layout
        margin = settings.checks.joint_margin
        self.limits = robot.lower + margin, robot.upper - margin
        self.speed = settings.approach.way_speed

    def change(self, old: int, new: int, first: int) -> tuple[list[FloatArray], list[Motion]]:
        """Points and motions that take the tool of one place back and that of another out, from home to home.

        The points are joint angles [rad] of shape (6,).

        Args:
            old: Place of the tool in the spindle, from 0.
            new: Place of the other tool.
            first: Number that the first of the points has in the program.

        Raises:
            NoWayError: A way touches something, and none was found that does not.
        """
        home, gauge = self.layout.home, self.rack.gauge
        stops: list[tuple[FloatArray, MotionKind | None, int, float]] = [
            (self.rack.places[old].front, MotionKind.PUT, old, self.rack.depth),
            (self.rack.places[new].front, MotionKind.TAKE, new, self.rack.depth),
            (gauge.front, MotionKind.MEASURE, new, gauge.depth),
            (home, None, new, 0.0),
        ]
        points: list[FloatArray] = []
        motions: list[Motion] = []
        at = home
        for goal, kind, place, depth in stops:
            for q in [*self._way(at, goal), goal]:
                motions.append(self._motion(MotionKind.ABSOLUTE, first + len(points), None))
                points.append(q)
            if kind is not None:
                self._check_seat(goal, depth)
                motions.append(self._motion(kind, first + len(points) - 1, place))
            at = goal
        return points, motions

    def _motion(self, kind: MotionKind, point: int, place: int | None) -> Motion:
        return Motion(kind, point, place, self.speed, "fine", "", False)

    def _way(self, start: FloatArray, goal: FloatArray) -> list[FloatArray]:
        found = joint_way(self.world, start, goal, (), self.limits)
        if isinstance(found, Contact):
            raise self._blocked("on a way at the rack", found)
        return found

    def _check_seat(self, front: FloatArray, depth: float) -> None:
        """Refuse a place into which the spindle does not get straight along its axis."""
        T = Kinematics(self.robot).forward(front)
        axis = T[:3, :3] @ self.layout.T_flange_tool[:3, 2]
        poses = np.tile(T, (SEAT_SAMPLES, 1, 1))
        poses[:, :3, 3] += np.linspace(0.0, depth, SEAT_SAMPLES)[:, None] * axis
        q = inverse_near(self.robot, poses, front)
        if not bool(((q >= self.limits[0]) & (q <= self.limits[1])).all()):
            raise NoWayError(
                "a place of the rack is out of the robot's reach, allowed are places that it gets into along its "
                "spindle's axis; choose another posture in front of it (rack in config/cell.yaml)",
                feature="",
            )
        found = contact_along(self.world, q, bulge_of(q))
        if found is not None:
            raise self._blocked("on the way into a place of the rack", found)

    def _blocked(self, what: str, found: Contact) -> NoWayError:
        return NoWayError(
            f"{what} {meeting(found, self.world)}, and no other way was found; choose other postures in front of the "
            "places (rack in config/cell.yaml), or take what is in the way out of it",
            feature="",
            **facts(found, self.world),
        )


def joined(programs: Sequence[tuple[int, MillingProgram]], ways: RackWays) -> MillingProgram:
    """One program of several, each from home to home with one tool.

    It begins and ends with the tool of the first place, whatever becomes of the door: the next one finds it there.

    Args:
        programs: Place of the tool, from 0, and what is milled with it.
        ways: To the rack and back.

    Raises:
        NoWayError: There is no way to the rack.
        ProgramSizeError: A controller does not keep as many points.
    """
    targets: list[Target] = []
    points: list[FloatArray] = []
    motions: list[Motion] = []
    escapes: list[range] = []
    carried = 0

    def change(to: int) -> None:
        nonlocal carried
        more, moved = ways.change(carried, to, len(points))
        points.extend(more)
        motions.extend(moved)
        carried = to

    for number, (place, program) in enumerate(programs):
        if place != carried:
            change(place)
        shift, first = len(targets), len(points)
        names = (f"{target.name}.{number + 1}" if number else target.name for target in program.targets)
        targets += [replace(t, name=name) for t, name in zip(program.targets, names, strict=True)]
        points += program.points
        motions += [_moved(motion, shift, first) for motion in program.motions]
        escapes += [range(e.start + first, e.stop + first) for e in program.escapes]
        if number + 1 < len(programs) or place:
            motions.append(Motion(MotionKind.ABSOLUTE, len(points), None, ways.speed, "fine", "", False))
            points.append(ways.layout.home)
    if carried:
        change(0)
    if len(points) > MOST_POINTS:
        raise ProgramSizeError(
            f"the program with its tool changes has {len(points)} points of joint space, allowed are {MOST_POINTS}; "
            "mill the door in several runs",
            feature="",
            found=len(points),
            allowed=MOST_POINTS,
        )
    last = programs[-1][1]
    return MillingProgram(
        last.door_id,
        last.recipe_version,
        tuple(targets),
        tuple(motions),
        tuple(points),
        last.home,
        tuple(escapes),
    )


def _moved(motion: Motion, targets: int, points: int) -> Motion:
    if motion.kind is MotionKind.ABSOLUTE:
        return replace(motion, target=motion.target + points)
    via = None if motion.via is None else motion.via + targets
    return replace(motion, target=motion.target + targets, via=via)
