"""From a recipe and a door pose to the corrected milling program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.worth import worth_of
from doormill_ros.frames import check_transform
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.toolpath.air.joint_speed import followable
from doormill_ros.toolpath.air.route import check_size, route
from doormill_ros.toolpath.curves.arcs import check_arcs, unfollowable
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.errors import ToolLengthError
from doormill_ros.toolpath.mills.tool_change import RackWays, joined
from doormill_ros.toolpath.mills.tool_life import check_life
from doormill_ros.toolpath.mills.tool_order import tool_shares
from doormill_ros.toolpath.mills.waiting_tools import beside_rack
from doormill_ros.toolpath.pacing.pace import paced
from doormill_ros.toolpath.placement import check_placement
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.toolpath.settings import PathSettings, load_settings
from doormill_ros.toolpath.stations import stations_of
from doormill_ros.toolpath.targets.adapt import adapted, straightened
from doormill_ros.toolpath.targets.assemble import assembled, steps_of
from doormill_ros.units import m_to_mm


def generate_program(
    recipe: Recipe,
    T_base_door: FloatArray,
    layout: CellLayout,
    robot: Robot,
    model: ComplianceModel,
    *,
    operations: Sequence[Operation] | None = None,
    settings: PathSettings | None = None,
) -> MillingProgram:
    """Nominal path on the displaced door, one robot configuration, correction, checks.

    Args:
        recipe: What to mill.
        T_base_door: Where the door stands, shape (4, 4).
        layout: Tool and fixture of the cell.
        robot: Which robot mills.
        model: How the robot gives way under the process wrench.
        operations: This robot's share of the work, see `split`; None for the whole recipe, with
            the door in the clamp of the layout.
        settings: Values of config/toolpath.yaml; None reads the file.

    Returns:
        Targets and motions. Nominal poses stand on the door's true place, corrected ones where the
        robot has to be sent.

    Raises:
        PathError: The leaf class says what makes the door impossible to mill.
    """
    settings = settings or load_settings()
    T_base_door = check_transform(T_base_door, "T_base_door")
    if operations is None:
        check_placement(T_base_door, recipe, layout)
        operations = whole_door(recipe)
    for item in operations:
        _check_length(item, settings)
    shares = tool_shares(operations, layout.rack, settings.checks.tools)
    made = []
    for share in shares:
        place = share.place or 0
        carried = None if layout.rack is None else layout.rack.places[place].tool
        about = beside_rack(layout, robot, settings, recipe.tools, carried)
        made.append(
            (place, _with_one_tool(recipe, T_base_door, about, robot, model, share.operations, settings))
        )
    program = made[0][1]
    if len(made) > 1 or made[0][0]:
        ways = RackWays(recipe, T_base_door, layout, robot, settings)
        program = joined(made, ways)
        check_size([motion.feature for motion in program.motions], settings)
    check_life(program, recipe)
    return program


def _with_one_tool(
    recipe: Recipe,
    T_base_door: FloatArray,
    layout: CellLayout,
    robot: Robot,
    model: ComplianceModel,
    operations: Sequence[Operation],
    settings: PathSettings,
) -> MillingProgram:
    """What is milled with one tool, from home to home."""
    loaded = LoadedRobot(
        Kinematics(robot),
        model,
        layout.T_flange_tool,
        settings.correction.tolerance,
        worth_of(robot, settings.correction.unmeasured, model),
    )
    plan, path = route(recipe, operations, T_base_door, layout, robot, settings)
    plan = replace(plan, steps=tuple(followable(plan.steps, path, robot, settings.checks)))
    if plan.fixed:
        stations, q = stations_of(plan.steps, T_base_door), path.stations
    else:
        plan, stations, q = adapted(plan, path.stations, T_base_door, loaded, settings.correction)
    program = assembled(recipe, plan, stations, q, loaded, robot, settings, layout.home)
    flat = unfollowable(program)
    if flat and not plan.fixed:
        # A step in the correction has bent an arc over that was almost a line.
        steps = steps_of(plan)
        plan, stations, q = straightened(plan, q, T_base_door, loaded, {steps[i] for i in flat})
        program = assembled(recipe, plan, stations, q, loaded, robot, settings, layout.home)
    if flat:
        check_arcs(program)
    return program if plan.fixed else paced(program, robot, settings)


def _check_length(item: Operation, settings: PathSettings) -> None:
    tool, nose, play = item.feature.tool, settings.approach.nose, settings.checks.tool_length
    if isinstance(tool, TabledTool) and abs(tool.length - nose) > play:
        raise ToolLengthError(
            f"{item.feature.id}: tool {tool.name!r} stands {m_to_mm(tool.length):g} mm out of the spindle, allowed are "
            f"{m_to_mm(nose):g} mm +- {m_to_mm(play):g} mm; clamp it so and correct the table, or teach the robot this "
            "mill and set tool.position (cell.yaml) and approach.nose (toolpath.yaml)",
            feature=item.feature.id,
            found=tool.length,
            allowed=nose,
        )
