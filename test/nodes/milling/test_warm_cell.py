"""The path generator undoes the growth of a cell by the doors that it has seen it begin."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Header

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.messages.from_message import transform_of
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.warmth.growth import GrowthLaw, ThermalGrowth
from support.path_generator_node import active_generator

DOOR = "thesis_190_0deg"
GROWTH = 2e-4
#: Warm within seconds, so that the time from door to door of a test is long.
LAW = ThermalGrowth((GrowthLaw(1e-4, GROWTH, 1e-7, 1.0),), 1.0, 600.0)


@pytest.fixture
def generator(tmp_path: Path) -> Iterator[PathGenerator]:
    robot = load_robot(load_layout().robot)
    model = tmp_path / "model.yaml"
    model.write_text(yaml.safe_dump(model_document(robot.name, robot.stiffness, (), "a test", growth=LAW)))
    with active_generator(robot_model=str(model), models="none") as node:
        yield node


def planned(node: PathGenerator, run_id: str) -> np.ndarray:
    """Corrected places of a door that comes now, shape (n, 3) [m]."""
    recipe = shipped_recipes()[DOOR]
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    header = Header()
    header.stamp.sec, header.stamp.nanosec = seconds, nanoseconds
    node._take_recipe(recipe_message(recipe, run_id, header))
    pose = pose_message(load_layout().T_base_door(recipe.width, recipe.thickness))
    node._take_pose(PoseStamped(header=header, pose=pose))
    answer = node._targets.messages[-1]
    assert answer.accepted, answer.reason
    return np.array([transform_of(target.corrected)[:3, 3] for target in answer.targets])


def test_the_first_door_is_cold_and_the_next_ones_are_as_warm_as_the_work_makes_them(
    generator: PathGenerator,
) -> None:
    cold = planned(generator, "r1")
    assert generator._health[2]["growth_undone"] == 0.0
    time.sleep(3.0)  # eight time constants
    warm = planned(generator, "r2")
    undone = generator._health[2]["growth_undone"]
    assert undone == pytest.approx(GROWTH, rel=0.01)
    moved = warm - cold
    # Sent back towards the base by as much, whatever else the targets are corrected for.
    toward = -np.sum(moved * cold, axis=1) / np.linalg.norm(cold, axis=1)
    assert np.median(toward) == pytest.approx(GROWTH, rel=0.05)
