"""Tool changes between the parts of a program: ways to the rack and back, and what is done there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.cell.places.rack import Rack, RackPlace
from doormill_ros.cell.rapid_limits import MAX_POINTS
from doormill_ros.collision.joint_way import joint_way
from doormill_ros.collision.sweep import Contact, bulge_of, contact_along
from doormill_ros.collision.world import MILL, World
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.air.clearance import facts, meeting
from doormill_ros.toolpath.air.route import door_world
from doormill_ros.toolpath.errors import NoWayError, ProgramSizeError
from doormill_ros.toolpath.mills.waiting_tools import NO_TOOL, beside_rack, tool_name
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.settings import PathSettings

SEAT_SAMPLES = 21  #: postures between the front of a place and its seat


class RackWays:
    """Motions from home through the rack and home again.

    They are checked with a mill in the spindle, so that they hold for an empty one as well, and among the tools that
    wait meanwhile.

    Args:
        recipe: The door and its tools.
        T_base_door: Where the door stands, shape (4, 4).
        layout: Home, tool and rack.
        robot: Whose joints.
        settings: Speeds and margins.
    """

    def __init__(
        self,
        recipe: Recipe,
        T_base_door: FloatArray,
        layout: CellLayout,
        robot: Robot,
        settings: PathSettings,
    ) -> None:
        if layout.rack is None:
            raise ValueError("the cell has no rack, allowed is one with places")
        self.rack: Rack = layout.rack
        self.recipe, self.T_base_door = recipe, T_base_door
        self.layout, self.robot, self.settings = layout, robot, settings
        self._worlds: dict[str, World] = {}
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
        put, take = self.rack.places[old], self.rack.places[new]
        # Where to, what is done there, at which place, and the tool in the spindle on the way.
        stops: list[tuple[FloatArray, MotionKind | None, int, str]] = [
            (put.front, MotionKind.PUT, old, put.tool),
            (take.front, MotionKind.TAKE, new, NO_TOOL),
            (gauge.front, MotionKind.MEASURE, new, take.tool),
            (home, None, new, take.tool),
        ]
        points: list[FloatArray] = []
        motions: list[Motion] = []
        at = home
        for goal, kind, place, carried in stops:
            world = self._world(carried)
            for q in [*self._way(world, at, goal), goal]:
                motions.append(self._motion(MotionKind.ABSOLUTE, first + len(points), None))
                points.append(q)
            if kind is MotionKind.MEASURE:
                self._check_seat(world, goal, gauge.depth)
            elif kind is not None:
                # The tool of this place is there before it is taken and after it was put back.
                self._check_seat(self._world(NO_TOOL), goal, self.rack.depth, self.rack.places[place])
            if kind is not None:
                motions.append(self._motion(kind, first + len(points) - 1, place))
            at = goal
        return points, motions

    def _motion(self, kind: MotionKind, point: int, place: int | None) -> Motion:
        return Motion(kind, point, place, self.speed, "fine", "", False)

    def _world(self, carried: str) -> World:
        """Robot, door and cell while a tool is in the spindle, by its name."""
        if carried not in self._worlds:
            about = beside_rack(self.layout, self.robot, self.settings, self.recipe.tools, carried)
            tool = self.recipe.tools.get(carried)
            widest = 0.0 if tool is None else tool.radius
            self._worlds[carried] = door_world(
                self.recipe, self.T_base_door, widest, about, self.robot, self.settings
            )
        return self._worlds[carried]

    def _way(self, world: World, start: FloatArray, goal: FloatArray) -> list[FloatArray]:
        found = joint_way(world, start, goal, (), self.limits)
        if isinstance(found, Contact):
            raise self._blocked("on a way at the rack", found, world)
        return found

    def _check_seat(
        self, world: World, front: FloatArray, depth: float, place: RackPlace | None = None
    ) -> None:
        """Refuse what the spindle does not get into straight along its axis; it may touch what is of a `place`."""
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
        changed = set() if place is None else {self.rack.held_in(place).name, tool_name(place)}
        spindle = {MILL, *(body.name for body in self.layout.spindle)}
        apart = [body not in spindle or obstacle not in changed for body, obstacle in world.names]
        found = contact_along(world, q, bulge_of(q), pairs=np.flatnonzero(apart))
        if found is not None:
            raise self._blocked("on the way into a place of the rack", found, world)

    def _blocked(self, what: str, found: Contact, world: World) -> NoWayError:
        return NoWayError(
            f"{what} {meeting(found, world)}, and no other way was found; choose other postures in front of the "
            "places (rack in config/cell.yaml), or take what is in the way out of it",
            feature="",
            **facts(found, world),
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
    if len(points) > MAX_POINTS:
        raise ProgramSizeError(
            f"the program with its tool changes has {len(points)} points of joint space, allowed are {MAX_POINTS}; "
            "mill the door in several runs",
            feature="",
            found=len(points),
            allowed=MAX_POINTS,
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
        last.tool,
    )


def _moved(motion: Motion, targets: int, points: int) -> Motion:
    if motion.kind is MotionKind.ABSOLUTE:
        return replace(motion, target=motion.target + points)
    via = None if motion.via is None else motion.via + targets
    return replace(motion, target=motion.target + targets, via=via)
