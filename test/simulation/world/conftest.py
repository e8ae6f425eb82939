"""What a controller commanded on a real run of the cell, and the published geometry of its robot."""

from dataclasses import dataclass

import numpy as np
import pytest

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.messages.from_message import recipe_of, transform_of, wrenches_of
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.world.door_truth import DoorTruth
from doormill_ros.simulation.world.world_file import load_world
from support.source_tree import ROOT

BAG = ROOT / "bags" / "thesis_190_0deg"


@dataclass(frozen=True, eq=False)
class RecordedDoor:
    """A door of a recorded cell that was as the project assumes.

    Attributes:
        recipe: The door.
        T_base_door: Where it stood.
        path: What the controller commanded; the tool as today's cell has it.
        dh: Table of the robot.
        T_flange_tool: Its tool.
    """

    recipe: Recipe
    T_base_door: FloatArray
    path: ExecutedPath
    dh: FloatArray
    T_flange_tool: FloatArray


@pytest.fixture(scope="session")
def recorded() -> RecordedDoor:
    """A thesis door, from its bag."""
    topics = ("/door/recipe", "/simulation/door_placement", "/simulation/executed_path")
    found = {item.topic: item.message for item in read_bag(BAG, topics)}
    recipe, placement, executed = (found[topic] for topic in topics)
    layout = load_layout()
    return RecordedDoor(
        recipe_of(recipe),
        transform_of(placement.pose),
        ExecutedPath(
            time=np.array(executed.time),
            T_base_tool=np.array([transform_of(pose) for pose in executed.actual]),
            T_base_tool_commanded=np.array([transform_of(pose) for pose in executed.commanded]),
            q=np.reshape(executed.joint_positions, (-1, 6)),
            motion=np.array(executed.motion),
            cutting=np.array(executed.cutting, dtype=bool),
            feature=np.array(executed.feature),
            wrench=wrenches_of(executed.wrench),
        ),
        load_robot(layout.robot).dh,
        layout.T_flange_tool,
    )


@pytest.fixture
def truth(recorded, tmp_path):
    """Maker of a door in a world: truth(text of the world file, number)."""

    def make(text: str = "", number: int = 0) -> DoorTruth:
        path = tmp_path / "world.yaml"
        path.write_text(f"schema: doormill/world/1\n{text}\n", encoding="utf-8")
        return DoorTruth(load_world(path), number, recorded.dh, recorded.T_flange_tool)

    return make
