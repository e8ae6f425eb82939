"""Ways through joint space: from home to the first feature, between features, and home from each of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.collision.joint_way import joint_way
from doormill_ros.collision.sweep import Contact, contact_along, contact_at
from doormill_ros.collision.world import World
from doormill_ros.frames import inverse
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.air.clearance import between_features, check_feature, facts, meeting
from doormill_ros.toolpath.air.reach import JointPath
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.errors import HomeContactError, NoWayError
from doormill_ros.toolpath.plan import Plan
from doormill_ros.toolpath.settings import PathSettings

ARM = slice(1, 3)  #: joints that draw the tool back: 2 and 3


def with_ways(
    plan: Plan,
    path: JointPath,
    operations: Sequence[Operation],
    T_base_door: FloatArray,
    world: World,
    robot: Robot,
    layout: CellLayout,
    settings: PathSettings,
) -> Plan:
    """The plan with the points of its ways through joint space, and with the way home from every feature.

    Args:
        plan: The steps.
        path: Joint angles along them.
        operations: What is milled, in this order.
        T_base_door: Where the door stands, shape (4, 4).
        world: Robot, door and cell.
        robot: Whose joints.
        layout: Home and tool.
        settings: Distances to draw back, and margins.

    Raises:
        HomeContactError: The robot touches something at home.
        BodyContactError: The arm touches something while the tool is in a feature.
        NoWayError: A way touches something, and none was found that does not.
    """
    found = contact_at(world, layout.home)
    if found is not None:
        raise HomeContactError(
            f"at home {meeting(found, world)}; choose other joints for home in config/cell.yaml and rapid/DoorCell.mod",
            **facts(found, world),
        )
    ways = _Ways(world, robot, layout, settings)
    steps, at = list(plan.steps), path.stations[:, -1]
    last = {step.feature: i for i, step in enumerate(steps) if step.feature}
    T_tool_flange = inverse(layout.T_flange_tool)
    escapes = []
    for item in operations:
        end = last[item.feature.id]
        check_feature(item, steps[end].curve.end, at[end], T_base_door, T_tool_flange, robot, world)
        escapes.append((at[end], *ways.homeward(at[end], f"home from {item.feature.id}", item.feature.id)))
    first = operations[0].feature.id
    points = ways.homeward(at[0], f"from home to {first}", first, escapes[0])
    steps[0] = replace(steps[0], points=tuple(points[::-1]))
    for i in range(1, len(steps)):
        if between_features(steps, i):
            before, after = steps[i - 1].feature, steps[i + 1].feature
            steps[i] = replace(steps[i], points=tuple(ways.across(at[i - 1], at[i], before, after)))
    return replace(plan, steps=tuple(steps), escapes=tuple(escapes))


class _Ways:
    """Finds ways from postures in front of features."""

    def __init__(self, world: World, robot: Robot, layout: CellLayout, settings: PathSettings) -> None:
        self.world, self.robot = world, robot
        self.rest: FloatArray = layout.home
        self.T_flange_tool = layout.T_flange_tool
        self.back = settings.approach.retreats
        margin = settings.checks.joint_margin
        self.limits = robot.lower + margin, robot.upper - margin
        self.kinematics = Kinematics(robot)
        self.helped = 0

    def homeward(
        self, q: FloatArray, what: str, feature: str, known: Sequence[FloatArray] = ()
    ) -> list[FloatArray]:
        """Points from a posture in front of a feature to home, both left out; `known` is a free way from near it."""
        if len(known) > 1 and contact_along(self.world, np.array([q, known[1]])) is None:
            return list(known[1:])
        hints: list[list[FloatArray]] = []

        def in_turn() -> Iterator[list[FloatArray]]:
            # What helped at the feature before is tried first; none is worked out where the straight way is free.
            hints.extend(self._by_way_home(q))
            order = sorted(range(len(hints)), key=lambda number: number != self.helped)
            yield from (hints[number] for number in order)

        found = self._way(q, self.rest, in_turn(), what, feature)
        self.helped = next((i for i, hint in enumerate(hints) if hint is found), self.helped)
        return found

    def across(self, q: FloatArray, goal: FloatArray, before: str, after: str) -> list[FloatArray]:
        """Points from in front of one feature to in front of another, both left out."""
        return self._way(q, goal, self._by_way_across(q, goal), f"from {before} to {after}", after)

    def _way(
        self, q: FloatArray, goal: FloatArray, hints: Iterable[list[FloatArray]], what: str, feature: str
    ) -> list[FloatArray]:
        found = joint_way(self.world, q, goal, hints, self.limits)
        if isinstance(found, Contact):
            raise NoWayError(
                f"{feature}: on the way {what} {meeting(found, self.world)}, and no other way was found; choose "
                "another home or another place of the robot, or take what is in the way out of it",
                feature=feature,
                **facts(found, self.world),
            )
        return found

    def _by_way_home(self, q: FloatArray) -> Iterator[list[FloatArray]]:
        drawn = self._drawn_back(q)
        yield from ([back] for back in drawn)
        for back in drawn:
            turned, folded = self.rest.copy(), back.copy()
            turned[0] = back[0]
            folded[ARM] = self.rest[ARM]
            yield [back, turned]
            yield [back, folded]
            yield [back, folded, turned]

    def _by_way_across(self, q: FloatArray, goal: FloatArray) -> Iterator[list[FloatArray]]:
        here, there = self._drawn_back(q), self._drawn_back(goal)
        yield from ([a, b] for a, b in zip(here, there, strict=False))
        yield from ([a, self.rest, b] for a, b in zip(here, there, strict=False))

    def _drawn_back(self, q: FloatArray) -> list[FloatArray]:
        """Postures with the tool drawn straight back, as far as the joints allow."""
        T_base_flange = self.kinematics.forward(q)
        axis = T_base_flange[:3, :3] @ self.T_flange_tool[:3, 2]
        poses = np.tile(T_base_flange, (len(self.back), 1, 1))
        poses[:, :3, 3] -= np.outer(self.back, axis)
        postures = inverse_near(self.robot, poses, q)
        # NaN, out of reach, is within no limits.
        within = ((postures >= self.limits[0]) & (postures <= self.limits[1])).all(axis=1)
        return list(postures[within])
