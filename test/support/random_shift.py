"""Shifts of doors of which no two are alike: drawn, planned, and milled by the worlds of world files."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta
from functools import lru_cache
from pathlib import Path

import numpy as np

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.diagnosis.parts.doors.recorded_cut import RecordedCut
from doormill_ros.diagnosis.parts.kind import InspectedDoor, inspected_door
from doormill_ros.measurements.inspections.inspection import inspections_in
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.world.door_truth import TAKT
from doormill_ros.toolpath.errors import PathError
from support.gauged_shift import BEGAN, SCATTER, Commanded, gauged_runs
from support.loop_worlds import timed
from support.milled_worlds import commanded
from support.source_tree import ROOT

NO_BAG = ROOT / "bags"  #: beside which nobody looks
LINE_STEP = 5e-4  #: between samples of a straight cut [m]
FOLLOWING = 1_000_000  #: added to the seed of a shift, gives that of the doors after it
#: What a localizer states of a pose [m, m, rad].
PLACING = np.diag([8.5e-5, 5e-5, 8e-5]) ** 2


def random_recipe(rng: np.random.Generator, name: str) -> Recipe:
    """One to four oblong hinges of the thesis on a door of any width, thickness and height of hinges."""
    recipe = load_recipe("thesis_190_0deg")
    count = int(rng.integers(1, 5))
    slot = 1.9 / count
    heights = [0.15 + slot * k + float(rng.uniform(0.0, slot - 0.2)) for k in range(count)]
    features = tuple(
        replace(recipe.features[0], id=f"hinge_{k + 1}", height=round(height, 4))
        for k, height in enumerate(heights)
    )
    width, thickness = (round(float(rng.uniform(*ends)), 3) for ends in ((0.29, 1.35), (0.04, 0.06)))
    return replace(recipe, door_id=name, width=width, thickness=thickness, features=features)


@lru_cache
def random_doors(seed: int, count: int) -> tuple[Commanded, ...]:
    """Doors that the planner accepts, each for itself."""
    rng, setup, found = np.random.default_rng([seed, 1717]), load_setup(), []
    while len(found) < count:
        recipe = random_recipe(rng, f"random_{len(found):03d}")
        y, z = rng.uniform(-0.008, 0.008, 2)
        offset = DoorOffset(float(y), float(z), float(rng.uniform(-0.03, 0.03)))
        T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
        try:
            planned = plan(recipe, T_base_door, setup)
        except PathError:
            continue
        tool = setup.layout.T_flange_tool
        path = timed(commanded(planned.program, setup.robot.dh, tool, LINE_STEP), planned)
        found.append(Commanded(NO_BAG, recipe.door_id, recipe, T_base_door, path))
    return tuple(found)


def next_doors(seed: int) -> tuple[tuple[Recipe, np.ndarray], ...]:
    """Recipes and places, T_base_door of shape (4, 4), of two doors that are in no shift of that seed."""
    return tuple((door.recipe, door.T_base_door) for door in random_doors(seed + FOLLOWING, 2))


def random_shift(
    folder: Path,
    world: dict,
    doors: tuple[Commanded, ...],
    seed: int,
    dh: np.ndarray | None = None,
    scatter: tuple[float, ...] = SCATTER,
) -> list[InspectedDoor]:
    """The doors as a world mills them, gauged and joined with what their runs tell.

    Args:
        folder: For the inspections.
        world: Content of a world file without its schema.
        doors: In order.
        seed: Of where the localizer's poses scatter.
        dh: Table of the robot that mills, shape (6, 4) [rad, m, m, rad]; None for the published one.
        scatter: Of their places along y and z [m], and of their angles [rad].
    """
    inspections = inspections_in(gauged_runs(folder, world, doors, seed, scatter, dh))
    began = [BEGAN + timedelta(seconds=number * TAKT) for number in range(len(doors))]
    return [
        inspected_door(inspection, _cut_of(door, at.timestamp()))
        for inspection, door, at in zip(inspections, doors, began, strict=True)
    ]


def _cut_of(door: Commanded, milled: float) -> RecordedCut:
    path = door.path
    return RecordedCut(
        tool=path.T_base_tool_commanded,
        q=path.q,
        wrench=path.wrench,
        time=path.time,
        cutting=path.cutting,
        feature=tuple(path.feature),
        recipe=door.recipe,
        T_base_door=door.T_base_door,
        placing=PLACING,
        milled=milled,
    )
