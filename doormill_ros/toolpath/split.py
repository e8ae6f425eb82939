"""Split a door between two milling robots, one on either side (thesis, appendix A.1).

The first robot, before the front, mills the hinges and the front half of every through hole; the
second, behind the door, the lock case and the other halves. Each feature that only one of them
can face goes to that one.
"""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.two_robots import FIRST, SECOND
from doormill_ros.frames import inverse
from doormill_ros.recipes.door import Side
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.cuts.operation import Operation, operation
from doormill_ros.toolpath.settings import PathSettings

_FACED = (Side.FRONT, Side.HINGE_EDGE)


@dataclass(frozen=True, eq=False)
class Share:
    """What one robot mills.

    Attributes:
        robot: "first" or "second".
        operations: In the order of milling.
        T_base_door: The door in this robot's base frame, shape (4, 4).
    """

    robot: str
    operations: tuple[Operation, ...]
    T_base_door: FloatArray


def split(recipe: Recipe, T_base_door: FloatArray, settings: PathSettings) -> tuple[Share, Share]:
    """The shares of the first and of the second robot; either may be empty.

    Args:
        recipe: The door.
        T_base_door: The door in the first robot's base frame, shape (4, 4).
        settings: Where the second robot stands.
    """
    first: list[Operation] = []
    second: list[Operation] = []
    for feature in recipe.features:
        near, far = (first, second) if feature.side in _FACED else (second, first)
        half = feature.halved
        near.append(operation(feature, recipe.size, half=half))
        if half:
            far.append(operation(feature, recipe.size, half=True, far_side=True))
    T_second_door = inverse(settings.second_robot.T_base_second) @ T_base_door
    return Share(FIRST, tuple(first), T_base_door), Share(SECOND, tuple(second), T_second_door)


def share_of(robot: str, recipe: Recipe, T_base_door: FloatArray, settings: PathSettings) -> Share:
    """What one of the two robots mills, by its name; the other arguments as of `split`."""
    return next(share for share in split(recipe, T_base_door, settings) if share.robot == robot)
