"""Loops from doors to doors without a cell: a shift in a world, what it teaches, and other doors milled with that."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import yaml

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.diagnosis.parts.correction.model import door_model_document
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.pipeline.plan import MillingSetup, PlannedProgram, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.program import Program
from doormill_ros.robot_model.warmth.work_times import WorkTimes
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.world.door_truth import TAKT, DoorTruth
from doormill_ros.simulation.world.world_file import load_world
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.milled_worlds import commanded
from support.shift_worlds import inspected
from support.told_world import told

TURNS = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), 9))
#: Recipe, program and place of doors that are in no bag of the shift.
UNSEEN = (
    ("thesis_190_0deg", Program.GENERAL, DoorOffset(0.004, -0.003, 0.004)),
    ("thesis_1350_0deg", Program.GENERAL, DoorOffset(-0.003, 0.004, -0.003)),
    ("thesis_1350_2deg", Program.PATH_20, DoorOffset(0.002, 0.002, np.radians(2.0))),
)
NUMBER = 12  #: of such a door in the shift: a few more were milled after those that taught
AS_ASSUMED = "as assumed"
GAP = {"gap": [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]}
SLIP = {"shift": [0.0, 1e-4, -1.5e-4], "from_door": 4}
WORLDS = {
    AS_ASSUMED: {},
    "force 30 % larger, a gap": {"force": {"factor": 1.3}, "change": [{"from_door": 5, "robot": GAP}]},
    "force 30 % smaller": {"force": {"factor": 0.7}},
    "force turned": {"force": {"angle": 0.3}},
    "clamp slipped": {"clamp": SLIP},
    "weight untold": {"tool": {"mass": 15.0, "com": [0.0, 0.0, 0.1]}},
}
#: Beyond what the tests take the time for.
MORE = {
    "joint 1 soft": {"robot": {"stiffness_factor": [0.6, 1.0, 1.0, 1.0, 1.0, 1.0]}},
    "mill bends": {"tool": {"stiffness": 2e6}},
    "arm warms up": {"temperature": {"rise": 20.0, "hours": 0.7, "growth": 1e-5}},
    "force, gap and clamp": {
        "force": {"factor": 1.3},
        "clamp": SLIP,
        "change": [{"from_door": 5, "robot": GAP}],
    },
}


@dataclass(frozen=True, eq=False)
class Loop:
    """A world's file, the diagnosis of nine doors in it, and the file of the model that it leaves."""

    world: Path
    diagnosis: DoorDiagnosis
    model: Path


def taught(folder: Path, world: dict) -> Loop:
    """Mill, gauge and question nine doors in a folder."""
    gauged_shift(folder, {"seed": 5, **world}, TURNS, 5)
    diagnosis = Inspections().diagnose(inspected(folder), lambda line: None)
    model = folder / "model.yaml"
    model.write_text(yaml.safe_dump(door_model_document(diagnosis, "a shift")), encoding="utf-8")
    return Loop(folder / "world.yaml", diagnosis, model)


def timed(path: ExecutedPath, planned: PlannedProgram) -> ExecutedPath:
    """A commanded path in the time that its plan takes: the ideal controller numbers its samples."""
    return replace(path, time=path.time * planned.time / path.time[-1])


def milled(
    setup: MillingSetup, world: Path, name: str, program: Program, offset: DoorOffset, aware: bool = False
) -> tuple[float, float, float]:
    """Wall errors of a door [m]: root mean square and largest, and the error that its plan expected.

    Args:
        setup: That plans it.
        world: That mills it.
        name, program, offset: The door and where it stands.
        aware: Whether the plan is told the world's own figures instead of its model's.
    """
    recipe = replace(load_recipe(name), program=program)
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
    dh, tool = setup.robot.dh, setup.layout.T_flange_tool
    truth = DoorTruth(load_world(world), NUMBER, dh, tool)
    work = WorkTimes(TAKT * number for number in range(NUMBER))
    knowing = told(setup, truth, recipe) if aware else setup.warm(work, TAKT * NUMBER)
    checked = plan(recipe, T_base_door, knowing)
    planned = checked.program
    stands = truth.T_base_door(T_base_door)
    part = inspect(
        recipe, stands, truth.executed(recipe, stands, timed(commanded(planned, dh, tool), checked))
    )
    # Without the deepest layer: where the floor is too high it lies in the wood, and has no wall.
    off = np.concatenate([np.ravel(feature.by_depth[:-1]) for feature in part.features])
    return float(np.sqrt(np.mean(off**2))), float(np.abs(off).max()), planned.expected_error
