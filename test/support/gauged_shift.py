"""Shifts of inspected doors without a cell: recorded commands, executed and gauged by the worlds of world files.

The controller's commands come from recorded runs, so every door of a kind was sent to the same place; where it really
stood scatters, and a moved camera puts it elsewhere, as a localizer that trusts its camera would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from pathlib import Path

import numpy as np
import yaml

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import inverse, rotation_from_vector, transform
from doormill_ros.localization.camera import load_camera
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.messages.from_message import recipe_of, transform_of, transforms_of, wrenches_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.world.door_truth import GAUGE, TAKT, DoorTruth
from doormill_ros.simulation.world.gauge import NOISE, gauge
from doormill_ros.simulation.world.world_file import load_world
from support.source_tree import ROOT

HINGE_DOORS = ("thesis_190_0deg", "thesis_1350_0deg", "thesis_190_2deg")
BEGAN = datetime(2026, 11, 22, 6, 0, tzinfo=UTC)
#: From one localization to the next [m, m, rad].
SCATTER = (8e-6, 8e-6, 1e-5)


@dataclass(frozen=True, eq=False)
class Commanded:
    """A run: its door, where the localizer put it, and what the controller commanded."""

    bag: Path
    run_id: str
    recipe: Recipe
    T_base_door: np.ndarray
    path: ExecutedPath


@lru_cache
def commanded(name: str) -> Commanded:
    """The run in a bag of the repository."""
    topics = ("/door/recipe", "/door/localization", "/simulation/executed_path")
    found = {item.topic: item.message for item in read_bag(ROOT / "bags" / name, topics)}
    recipe, located, executed = (found[topic] for topic in topics)
    tool = transforms_of(executed.commanded)
    path = ExecutedPath(
        time=np.array(executed.time),
        T_base_tool=tool,
        T_base_tool_commanded=tool,
        q=np.reshape(executed.joint_positions, (-1, 6)),
        motion=np.array(executed.motion),
        cutting=np.array(executed.cutting, dtype=bool),
        feature=np.array(executed.feature),
        wrench=wrenches_of(executed.wrench),
    )
    return Commanded(
        ROOT / "bags" / name, executed.run_id, recipe_of(recipe), transform_of(located.pose.pose), path
    )


def gauged_shift(
    folder: Path,
    world: dict,
    doors: tuple[str, ...],
    seed: int,
    scatter: tuple[float, ...] = SCATTER,
    dh: np.ndarray | None = None,
) -> Path:
    """As `gauged_runs`, of doors that were recorded in bags of these names."""
    return gauged_runs(folder, world, [commanded(name) for name in doors], seed, scatter, dh)


def gauged_runs(
    folder: Path,
    world: dict,
    runs: Sequence[Commanded],
    seed: int,
    scatter: tuple[float, ...] = SCATTER,
    dh: np.ndarray | None = None,
) -> Path:
    """Write the inspections of a shift below a folder.

    Args:
        folder: Gets a folder a door.
        world: Content of a world file without its schema.
        runs: What was commanded, in order.
        seed: Of where the doors stood.
        scatter: Of these places along y and z [m], and of their angles [rad].
        dh: Table of the robot that mills, shape (6, 4) [rad, m, m, rad]; None for the published one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "world.yaml"
    file.write_text(yaml.safe_dump({"schema": "doormill/world/1", **world}), encoding="utf-8")
    shift, layout, rng = load_world(file), load_layout(), np.random.default_rng([seed, 16])
    dh = load_robot(layout.robot).dh if dh is None else dh
    for number, run in enumerate(runs):
        truth = DoorTruth(shift, number, dh, layout.T_flange_tool)
        T_base_door = stood(truth, run.recipe, run.T_base_door, rng.normal(0.0, scatter))
        executed = truth.executed(run.recipe, T_base_door, run.path)
        points = gauge(run.recipe, T_base_door, executed, truth.drawn(GAUGE))
        at = BEGAN + timedelta(seconds=(number + 1) * TAKT)
        write_inspection(folder / f"door_{number:03d}", run.bag, run.run_id, at, NOISE, points)
    return folder


def stood(truth: DoorTruth, recipe: Recipe, believed: np.ndarray, off: np.ndarray) -> np.ndarray:
    """T_base_door while it is milled, shape (4, 4).

    Args:
        truth: Of the door: its camera and its clamp.
        recipe: The door.
        believed: Where a localizer that trusts its camera put it, shape (4, 4).
        off: What that localization scattered by: along y and z [m], and its angle [rad].
    """
    y, z, angle = off
    moved, turned = truth.camera_moved
    about = transform(translation=load_camera().position - [0.0, recipe.width / 2.0, 0.0])
    seen = (
        transform(translation=[0.0, moved[1] + y, moved[2] + z]) @ about @ transform(turned) @ inverse(about)
    )
    corner = transform(rotation_from_vector(np.array([angle, 0.0, 0.0])))
    return truth.T_base_door(seen @ believed @ corner)
