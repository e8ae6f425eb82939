"""Find a way round the door that the robot can go without touching the wood."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.clearance import check_air, check_holder
from doormill_ros.toolpath.door_plan import door_plan
from doormill_ros.toolpath.errors import (
    AirMoveError,
    ConfigurationChangeError,
    PathError,
    PathJointLimitError,
    PathSingularityError,
    ProgramSizeError,
)
from doormill_ros.toolpath.operation import Operation
from doormill_ros.toolpath.plan import Plan
from doormill_ros.toolpath.reach import JointPath, joint_path
from doormill_ros.toolpath.settings import PathSettings


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
    there and changes joint by joint.

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
    check_holder(operations, settings.approach)
    retreats: dict[int, float] = {}
    while True:
        plan = door_plan(recipe, operations, settings, retreats)
        check_size([step.feature for step in plan.steps], settings)  # before the costly part
        try:
            path = joint_path(plan.steps, T_base_door, robot, layout.T_flange_tool, settings)
            check_air(plan.steps, path, recipe.size, T_base_door, robot, layout, settings.approach)
            return plan, path
        except (PathSingularityError, PathJointLimitError, ConfigurationChangeError, AirMoveError) as error:
            if plan.fixed or not _draw_back(retreats, error, operations, settings.approach.retreats):
                raise


def _draw_back(
    retreats: dict[int, float], error: PathError, operations: Sequence[Operation], distances: Sequence[float]
) -> bool:
    """Note one more retreat that may help; False when there is none left to try."""
    number = next((i for i, o in enumerate(operations) if o.feature.id == error.data.get("feature")), 0)
    if isinstance(error, AirMoveError):
        farther = [d for d in distances if d > retreats.get(number, 0.0)]
        if farther:
            retreats[number] = farther[0]
        return bool(farther)
    # Free the robot before the feature that it cannot serve, then after it, then anywhere.
    around = [number, number + 1, *range(len(operations))]
    free = [i for i in around if 0 < i < len(operations) and i not in retreats]
    if free:
        retreats[free[0]] = distances[0]
    return bool(free)


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
