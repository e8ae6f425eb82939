"""Programs of a door before it stands in a cell: to look at, and to time."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import DoorOffset, load_layout
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_model import load_model_of
from doormill_ros.toolpath.door_checks import DoorCheck, check_door
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split


@dataclass(frozen=True, eq=False)
class Preview:
    """What one robot would do.

    Attributes:
        robot: "only" for a cell with one robot, else "first" or "second".
        T_base_door: Where the door stands, this robot's base frame, shape (4, 4).
        program: Its program.
        check: Its margins and times.
    """

    robot: str
    T_base_door: FloatArray
    program: MillingProgram
    check: DoorCheck


def preview(recipe: Recipe, robots: int = 1, model: str | None = None) -> list[Preview]:
    """Generate the programs of a door where its recipe places it, or in its nominal place.

    Args:
        recipe: The door.
        robots: 1, or 2 for one on either side.
        model: Robot or model.yaml of a diagnosis that the correction takes; None for the joint
            springs of the cell's robot.

    Returns:
        One entry for each robot that has something to mill.

    Raises:
        PathError: The door cannot be milled; the leaf class says why.
    """
    layout, settings = load_layout(), load_settings()
    robot = load_robot(layout.robot)
    compliance = load_model_of(robot, model or "")
    place = recipe.placement
    offset = DoorOffset() if place is None else DoorOffset(place.y, place.z, place.rotation)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness, offset)
    if robots == 1:
        shares = [("only", T_base_door, None)]
    else:
        both = split(recipe, T_base_door, settings)
        shares = [(share.robot, share.T_base_door, share.operations) for share in both if share.operations]
    found = []
    for name, T_robot_door, operations in shares:
        program = generate_program(
            recipe, T_robot_door, layout, robot, compliance, operations=operations, settings=settings
        )
        found.append(Preview(name, T_robot_door, program, check_door(program, recipe, robot, settings)))
    return found
