"""What the loop is worth in a drawn shift: the next doors, which no fit has seen, without and with what it taught."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import yaml

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.diagnosis.parts.correction.model import door_model_document
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.pipeline.plan import MillingSetup, load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.program import Program
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot_model.warmth.work_times import WorkTimes
from doormill_ros.simulation.world.door_truth import GAUGE, TAKT, DoorTruth
from doormill_ros.simulation.world.gauge import gauge
from doormill_ros.simulation.world.world_file import ShiftWorld, load_world
from doormill_ros.toolpath.errors import PathError
from support.gauged_shift import SCATTER, stood
from support.loop_worlds import TURNS, timed
from support.milled_worlds import commanded
from support.shift_worlds import DrawnShift, diagnosed
from support.told_world import told

#: Times what gauge, localization and program leave where everything is as assumed, that the loop may leave.
LEFT = 1.5
#: The next doors of a shift: door and place, in no bag of the repository.
NEXT = (
    ("thesis_190_0deg", DoorOffset(0.004, -0.003, 0.004)),
    ("thesis_1350_0deg", DoorOffset(-0.003, 0.004, -0.003)),
)
NIGHT = 12 * 3600.0  #: that nothing is milled [s]


@dataclass(frozen=True)
class LoopWorth:
    """Walls of the next doors as the gauge measures them, root mean square [m]; nan where one of them was refused.

    Attributes:
        least: Where everything is as assumed and known: what gauge, localization and program leave.
        before: In the world of the shift, with the springs that the robot came with.
        after: There, with the model that the doors of the shift left.
        told: There, with the world's own figures.
    """

    least: float
    before: float
    after: float
    told: float = float("nan")

    @property
    def kept(self) -> bool:
        """Whether the loop leaves no more than it may."""
        return self.after <= LEFT * self.least

    @property
    def as_told(self) -> bool:
        """Whether it leaves no more than it may beside a plan that knows the world, the scatter of its gears included.

        A door that such a plan refuses, too, is for nobody to mill.
        """
        return bool(np.isnan(self.told)) or self.after <= LEFT * max(self.least, self.told)

    @property
    def worse(self) -> bool:
        """Whether it would have been better not to accept the model."""
        return self.after > self.before


class NextMorning(DoorTruth):
    """A door of a cell that began to work with another one, after a night."""

    def __init__(
        self, world: ShiftWorld, number: int, dh: np.ndarray, T_flange_tool: np.ndarray, first: int
    ) -> None:
        """As `DoorTruth`; `first` is the number of the door with which the cell began."""
        super().__init__(world, number, dh, T_flange_tool)
        self._first = first

    def grown(self, time: np.ndarray, points: np.ndarray, flange: np.ndarray) -> np.ndarray:
        """As warm as since the cell began."""
        return super().grown(time - self._first * TAKT, points, flange)


@dataclass(frozen=True, eq=False)
class NextDoors:
    """The doors that follow those of a shift, at once or after a night.

    Attributes:
        world: That mills them.
        number: Of the first of them in the shift.
        seed: Of where the localizer puts them.
        morning: Whether a night lies before them.
        doors: Recipe and place, T_base_door of shape (4, 4), of each; none for `NEXT`.
    """

    world: ShiftWorld
    number: int
    seed: int
    morning: bool = False
    doors: Sequence[tuple[Recipe, np.ndarray]] = ()

    def truth(self, number: int, setup: MillingSetup) -> DoorTruth:
        """Of one of them."""
        robot = setup.robot.dh, setup.layout.T_flange_tool
        if self.morning:
            return NextMorning(self.world, number, *robot, self.number)
        return DoorTruth(self.world, number, *robot)

    def walls(self, setup: MillingSetup, aware: bool = False) -> float:
        """Walls as gauged, root mean square [m]; nan when one is refused.

        Args:
            setup: That plans them.
            aware: Whether it is told the world's own figures instead of its model's.
        """
        rng, off = np.random.default_rng([self.seed, 17]), []
        dh, tool = setup.robot.dh, setup.layout.T_flange_tool
        work = WorkTimes([] if self.morning else [TAKT * door for door in range(self.number)])
        doors = self.doors or [_stands(load_recipe(name), offset, setup) for name, offset in NEXT]
        for number, (own, believed) in enumerate(doors, self.number):
            recipe = replace(own, program=Program.GENERAL)
            scatter = rng.normal(0.0, SCATTER)
            truth = self.truth(number, setup)
            moment = TAKT * number + (NIGHT if self.morning else 0.0)
            work.worked(moment)
            knowing = told(setup, truth, recipe) if aware else setup.warm(work, moment)
            try:
                planned = plan(recipe, believed, knowing)
            except PathError:
                return float("nan")
            T_base_door = stood(truth, recipe, believed, scatter)
            path = timed(commanded(planned.program, dh, tool), planned)
            executed = truth.executed(recipe, T_base_door, path)
            points = gauge(recipe, T_base_door, executed, truth.drawn(GAUGE))
            off.append(points.deviation[np.array(points.surface) == "wall"])
        return float(np.sqrt(np.mean(np.concatenate(off) ** 2)))


def loop_worth(
    folder: Path,
    diagnosis: DoorDiagnosis,
    count: int,
    seed: int,
    knowing: MillingSetup,
    morning: bool = False,
    doors: Sequence[tuple[Recipe, np.ndarray]] = (),
) -> LoopWorth:
    """Mill and gauge the doors that follow a shift.

    Args:
        folder: That holds the shift as it was gauged.
        diagnosis: Of its doors.
        count: How many they were.
        seed: They were gauged with.
        knowing: See `untroubled`.
        morning: Whether a night lies between.
        doors: See `NextDoors`.
    """
    aware = setup_with(folder / "model.yaml", diagnosis)
    assumed = folder / "as_assumed.yaml"
    assumed.write_text(yaml.safe_dump({"schema": "doormill/world/1", "seed": seed}), encoding="utf-8")
    following = NextDoors(load_world(folder / "world.yaml"), count, seed, morning, doors)
    return LoopWorth(
        NextDoors(load_world(assumed), count, seed, doors=doors).walls(knowing),
        following.walls(load_setup()),
        following.walls(aware),
        following.walls(load_setup(), aware=True),
    )


def _stands(recipe: Recipe, offset: DoorOffset, setup: MillingSetup) -> tuple[Recipe, np.ndarray]:
    return recipe, setup.layout.T_base_door(recipe.width, recipe.thickness, offset)


@cache
def knowing() -> MillingSetup:
    """The setup of a shift that nothing troubled, once in each process."""
    with tempfile.TemporaryDirectory(prefix="shift-") as folder:
        return untroubled(Path(folder) / "shift")


def untroubled(folder: Path) -> MillingSetup:
    """The setup that a shift leaves in which everything was as assumed, gauged in a folder."""
    nothing = DrawnShift({"seed": 0}, (), TURNS)
    return setup_with(folder / "model.yaml", diagnosed(folder, nothing, 0))


def setup_with(model: Path, diagnosis: DoorDiagnosis) -> MillingSetup:
    """The setup whose model a diagnosis leaves, written to a file."""
    model.write_text(yaml.safe_dump(door_model_document(diagnosis, "a shift")), encoding="utf-8")
    return load_setup(model=str(model))
