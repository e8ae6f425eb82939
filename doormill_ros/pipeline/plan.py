"""From a door's pose and its recipe to the program that mills it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.two_robots import FIRST
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.correction.gravity import with_gravity
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.robot_model.extended_model import load_model_of
from doormill_ros.robot_model.warmth.grown_model import grown, growth_in
from doormill_ros.robot_model.warmth.work_times import WorkTimes
from doormill_ros.toolpath.beside import place_of
from doormill_ros.toolpath.door_plan import door_plan, whole_door
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.pacing.timing import motion_times, program_time
from doormill_ros.toolpath.placement import check_placement
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.toolpath.settings import PathSettings, load_settings
from doormill_ros.toolpath.split import Share, share_of

REHEARSED = "standard_door"


@dataclass(frozen=True, eq=False)
class MillingSetup:
    """What a program depends on beside recipe and pose.

    Attributes:
        layout: Tool and fixture of the cell.
        robot: Which robot mills.
        model: How it gives way under the process wrench, and sags under the weights that the cell tells of; in the
            cold, see `warm`.
        model_name: What the model is called where programs are written down.
        settings: Values of config/toolpath.yaml.
        share: "first" or "second" of two robots that mill a share of each door, its layout in its own base frame;
            empty for the only one, which mills whole doors.
        growth: Way of the tool away from the base that the model has by its warmth [m]; None where it tells nothing of
            that, or `warm` was not asked.
    """

    layout: CellLayout
    robot: Robot
    model: ComplianceModel
    model_name: str
    settings: PathSettings
    share: str = ""
    growth: float | None = None

    def of(self, robot: str) -> MillingSetup:
        """The setup of the first or the second of two robots, made from that of the only one."""
        return replace(self, layout=place_of(robot, self.layout, self.robot, self.settings), share=robot)

    def warm(self, work: WorkTimes, moment: float) -> MillingSetup:
        """The setup for a door at a moment [s since the epoch], as warm as the work of the cell until then has it."""
        growth = growth_in(self.model)
        if growth is None:
            return self
        way, std = growth.at(work, moment)
        return replace(self, model=grown(self.model, Kinematics(self.robot), growth, way, std), growth=way)

    def shared(self, recipe: Recipe, T_base_door: FloatArray) -> Share:
        """What this robot mills of a door that stands at T_base_door in the first one's base frame, shape (4, 4)."""
        if self.share:
            return share_of(self.share, recipe, T_base_door, self.settings)
        return Share(FIRST, tuple(whole_door(recipe)), T_base_door)


@dataclass(frozen=True)
class PlannedProgram:
    """A program, and how long it takes from home to home with reading it [s]."""

    program: MillingProgram
    time: float


def load_setup(robot: str = "", model: str = "", share: str = "") -> MillingSetup:
    """Read config/ once, for any number of doors.

    Args:
        robot: Robot description in config/robots; empty: the one of config/cell.yaml.
        model: Robot or model.yaml of a diagnosis that the correction takes; empty: the robot's joint springs.
        share: "first" or "second" of two robots; empty: the only one.

    Raises:
        BadCellFile: The cell tells weights that the robot cannot have.
        RobotError: There is no such robot, or its file is not of its form.
        ExtendedModelError: There is no such model, or it is of another robot.
        PoseModelError: The model's part from poses is not of its form.
    """
    layout = load_layout()
    arm = load_robot(robot or layout.robot)
    name = model or arm.name
    sagging = with_gravity(load_model_of(arm, name), arm, layout.gravity)
    setup = MillingSetup(layout, arm, sagging, name, load_settings())
    return setup.of(share) if share else setup


def rehearse(setup: MillingSetup) -> tuple[Recipe, FloatArray, PlannedProgram]:
    """Plan a shipped door with all that a door has, so that the next one is as fast as any.

    Returns:
        Recipe, T_base_door of shape (4, 4) and program.

    Raises:
        PathError: The robot of this setup cannot mill that door.
    """
    recipe = load_recipe(REHEARSED)
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    return recipe, T_base_door, plan(recipe, T_base_door, setup)


def prepare(recipe: Recipe, setup: MillingSetup) -> None:
    """Work out what does not depend on where the door stands, so that its pose need not wait for it; see `plan`.

    Raises:
        PathError: NothingToMillError or ToolFitError.
    """
    door_plan(recipe, setup.shared(recipe, np.eye(4)).operations, setup.settings)


def plan(
    recipe: Recipe,
    T_base_door: FloatArray,
    setup: MillingSetup,
) -> PlannedProgram:
    """Generate the program of a door.

    Args:
        recipe: What to mill.
        T_base_door: Where the door stands, in the base frame of the only or the first robot, shape (4, 4).
        setup: Robot, model, tool and settings, and which share of the door the robot mills.

    Raises:
        PathError: The leaf class says what makes the door impossible to mill.
    """
    check_placement(T_base_door, recipe, setup.layout)
    share = setup.shared(recipe, T_base_door)
    program = generate_program(
        recipe,
        share.T_base_door,
        setup.layout,
        setup.robot,
        setup.model,
        operations=share.operations,
        settings=setup.settings,
    )
    times = motion_times(program, setup.robot, setup.settings.cycle)
    return PlannedProgram(program, program_time(program, times, setup.settings.cycle))
