"""Find a way round the door that the robot can go without touching the wood."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.collision.world import Mill, PlacedDoor, World
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.configuration import configuration_index
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import BRANCHES
from doormill_ros.toolpath.air.clearance import check_air, check_holder
from doormill_ros.toolpath.air.far_side import check_far_side
from doormill_ros.toolpath.air.reach import JointPath, joint_path
from doormill_ros.toolpath.air.ways import with_ways
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.door_plan import door_plan
from doormill_ros.toolpath.errors import (
    AirMoveError,
    BodyContactError,
    ConfigurationChangeError,
    NoWayError,
    PathError,
    PathJointLimitError,
    PathSingularityError,
    ProgramSizeError,
)
from doormill_ros.toolpath.plan import Plan
from doormill_ros.toolpath.settings import PathSettings

_CURABLE = (
    PathSingularityError,
    PathJointLimitError,
    ConfigurationChangeError,
    AirMoveError,
    BodyContactError,
    NoWayError,
)


def route(
    recipe: Recipe,
    operations: Sequence[Operation],
    T_base_door: FloatArray,
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
) -> tuple[Plan, JointPath]:
    """A plan whose every pose the robot reaches.

    Straight ways close to the door are tried first. Where one leads through a singularity, or
    keeps the robot in a configuration that does not serve the next feature, the robot draws back
    there and changes joint by joint, farther where something would be touched, and goes by points of joint space where
    that does not help. What cannot be served in one configuration without touching something is tried in others,
    and what no one posture of the arm serves in several.

    Args:
        recipe: The door.
        operations: What this robot mills.
        T_base_door: Where the door stands, shape (4, 4).
        layout: Tool.
        robot: Whose joints.
        settings: Clearances, margins, limits.

    Raises:
        PathError: The leaf says which feature cannot be served, and why.
    """
    check_holder(operations, settings.approach, layout.clearance)
    check_far_side(operations, recipe.size, layout.boards)
    widest = max((item.feature.tool.radius for item in operations), default=0.0)
    world = door_world(recipe, T_base_door, widest, layout, robot, settings)
    choice = _Choice()
    while True:
        plan = door_plan(recipe, operations, settings, choice.retreats, choice.free)
        check_size([step.feature for step in plan.steps], settings)  # before the costly part
        path: JointPath | None = None
        try:
            path = joint_path(
                plan.steps,
                T_base_door,
                robot,
                layout.T_flange_tool,
                settings,
                choice.branches,
                choice.turn_over,
            )
            check_air(plan.steps, path, world)
            return with_ways(plan, path, operations, T_base_door, world, robot, layout, settings), path
        except _CURABLE as error:
            if path is not None and isinstance(error, BodyContactError | NoWayError):
                first = choice.first = choice.first or error
                used = configuration_index(robot, path.stations[:, -1])
                choice.branches = tuple(b for b in choice.branches if b not in used)
                if not choice.branches:
                    raise first from None
            elif plan.fixed:
                raise choice.first or error from None
            elif not choice.draw_back(error, operations, settings.approach.retreats):
                if choice.turn_over:
                    raise choice.first or error from None
                choice.first, choice.turn_over = choice.first or error, True


def door_world(
    recipe: Recipe,
    T_base_door: FloatArray,
    widest: float,
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
) -> World:
    """Robot, cell and a door that stands at T_base_door, shape (4, 4), with a mill in the spindle.

    Its radius is that of the widest one there may be [m], and at least what the settings say.
    """
    mill = Mill(settings.approach.nose, max(widest, settings.approach.mill_radius))
    size = np.array([recipe.thickness, recipe.width, recipe.height])
    return World(robot, layout, mill, PlacedDoor(size, T_base_door))


@dataclass(eq=False)
class _Choice:
    """What is tried next.

    Attributes:
        retreats: How far the robot draws back before an operation [m].
        free: Operations to which it goes through joint space.
        branches: Branches that have not failed.
        first: Why the first choice of branches failed.
        turn_over: Whether the arm may take another posture from one operation to the next.
    """

    retreats: dict[int, float] = field(default_factory=dict)
    free: set[int] = field(default_factory=set)
    branches: tuple[int, ...] = tuple(range(BRANCHES))
    first: PathError | None = None
    turn_over: bool = False

    def draw_back(
        self, error: PathError, operations: Sequence[Operation], distances: Sequence[float]
    ) -> bool:
        """Note one more retreat that may help; False when there is none left to try."""
        number = next((i for i, o in enumerate(operations) if o.feature.id == error.data.get("feature")), 0)
        held = number > 0 and number not in self.free
        if isinstance(error, AirMoveError):
            farther = [d for d in distances if d > self.retreats.get(number, 0.0)]
            if held and farther and operations[number].side is operations[number - 1].side:
                self.retreats[number] = farther[0]
                return True
        else:
            # Free the robot before the feature that it cannot serve, then after it, then anywhere.
            around = [number, number + 1, *range(len(operations))]
            near = [i for i in around if 0 < i < len(operations) and i not in self.retreats]
            if near:
                self.retreats[near[0]] = distances[0]
                return True
        # What cannot be done may be the way round the door and not the feature.
        if held:
            self.free.add(number)
        return held


def check_size(features: Sequence[str], settings: PathSettings) -> None:
    """Refuse more targets than a controller keeps.

    Args:
        features: Feature of every target, or of every step when targets are not known yet.
        settings: The limit.

    Raises:
        ProgramSizeError: There are too many.
    """
    found, allowed = len(features), settings.checks.targets
    if found > allowed:
        feature, most = Counter(features).most_common(1)[0]
        raise ProgramSizeError(
            f"{feature}: it takes {most} of the program's {found} targets, allowed are {allowed}; use a wider "
            "tool or deeper steps",
            feature=feature,
            found=found,
            allowed=allowed,
        )
