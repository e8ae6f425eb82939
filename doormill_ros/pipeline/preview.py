"""Programs of a door before it stands in a cell: to look at, and to time."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.two_robots import FIRST, SECOND
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.door_checks import DoorCheck, check_door
from doormill_ros.toolpath.program import MillingProgram


@dataclass(frozen=True, eq=False)
class ProgramPreview:
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


def preview(recipe: Recipe, robots: int = 1, model: str | None = None) -> list[ProgramPreview]:
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
    setup = load_setup(model=model or "")
    place = recipe.placement
    offset = DoorOffset() if place is None else DoorOffset(place.y, place.z, place.rotation)
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
    setups = [("only", setup)] if robots == 1 else [(name, setup.of(name)) for name in (FIRST, SECOND)]
    previews = []
    for name, own in setups:
        share = own.shared(recipe, T_base_door)
        if share.operations:
            program = plan(recipe, T_base_door, own).program
            check = check_door(program, recipe, own.robot, own.settings)
            previews.append(ProgramPreview(name, share.T_base_door, program, check))
    return previews
