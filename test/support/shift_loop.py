"""What the loop is worth in a drawn shift: the next doors, which no fit has seen, without and with what it taught."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import yaml

from doormill_ros.cell.layout import DoorOffset
from doormill_ros.diagnosis.parts.model import door_model_document
from doormill_ros.diagnosis.parts.problem import DoorDiagnosis
from doormill_ros.pipeline.plan import MillingSetup, load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.world.door_truth import GAUGE, DoorTruth
from doormill_ros.simulation.world.gauge import gauge
from doormill_ros.simulation.world.world_file import ShiftWorld, load_world
from doormill_ros.toolpath.errors import PathError
from support.gauged_shift import SCATTER, stood
from support.loop_worlds import TURNS
from support.milled_worlds import commanded
from support.shift_worlds import DrawnShift, diagnosed

#: Times what gauge, localization and program leave where everything is as assumed, that the loop may leave.
LEFT = 1.5
#: The next doors of a shift: door and place, in no bag of the repository.
NEXT = (
    ("thesis_190_0deg", DoorOffset(0.004, -0.003, 0.004)),
    ("thesis_1350_0deg", DoorOffset(-0.003, 0.004, -0.003)),
)


@dataclass(frozen=True)
class LoopWorth:
    """Walls of the next doors as the gauge measures them, root mean square [m]; nan where one of them was refused.

    Attributes:
        least: Where everything is as assumed and known: what gauge, localization and program leave.
        before: In the world of the shift, with the springs that the robot came with.
        after: There, with the model that the doors of the shift left.
    """

    least: float
    before: float
    after: float

    @property
    def kept(self) -> bool:
        """Whether the loop leaves no more than it may."""
        return self.after <= LEFT * self.least

    @property
    def worse(self) -> bool:
        """Whether it would have been better not to accept the model."""
        return self.after > self.before


def loop_worth(
    folder: Path, diagnosis: DoorDiagnosis, count: int, seed: int, knowing: MillingSetup
) -> LoopWorth:
    """Mill and gauge the doors that follow a shift.

    Args:
        folder: That holds the shift as it was gauged.
        diagnosis: Of its doors.
        count: How many they were.
        seed: They were gauged with.
        knowing: See `untroubled`.
    """
    world, aware = load_world(folder / "world.yaml"), setup_with(folder / "model.yaml", diagnosis)
    assumed = folder / "as_assumed.yaml"
    assumed.write_text(yaml.safe_dump({"schema": "doormill/world/1", "seed": seed}), encoding="utf-8")
    return LoopWorth(
        walls(knowing, load_world(assumed), count, seed),
        walls(load_setup(), world, count, seed),
        walls(aware, world, count, seed),
    )


def untroubled(folder: Path) -> MillingSetup:
    """The setup that a shift leaves in which everything was as assumed, gauged in a folder."""
    nothing = DrawnShift({"seed": 0}, (), TURNS)
    return setup_with(folder / "model.yaml", diagnosed(folder, nothing, 0))


def setup_with(model: Path, diagnosis: DoorDiagnosis) -> MillingSetup:
    """The setup whose model a diagnosis leaves, written to a file."""
    model.write_text(yaml.safe_dump(door_model_document(diagnosis, "a shift")), encoding="utf-8")
    return load_setup(model=str(model))


def walls(setup: MillingSetup, world: ShiftWorld, number: int, seed: int) -> float:
    """Walls of the next doors as gauged, root mean square [m]; nan when one is refused.

    Args:
        setup: That plans them.
        world: That mills them.
        number: Of the first of them in the shift.
        seed: Of where the localizer puts them.
    """
    rng, off = np.random.default_rng([seed, 17]), []
    dh, tool = setup.robot.dh, setup.layout.T_flange_tool
    for later, (name, offset) in enumerate(NEXT):
        recipe = replace(load_recipe(name), program=Program.GENERAL)
        believed = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
        scatter = rng.normal(0.0, SCATTER)
        try:
            planned = plan(recipe, believed, setup).program
        except PathError:
            return float("nan")
        truth = DoorTruth(world, number + later, dh, tool)
        T_base_door = stood(truth, recipe, believed, scatter)
        executed = truth.executed(recipe, T_base_door, commanded(planned, dh, tool))
        points = gauge(recipe, T_base_door, executed, truth.drawn(GAUGE))
        off.append(points.deviation[np.array(points.surface) == "wall"])
    return float(np.sqrt(np.mean(np.concatenate(off) ** 2)))
