"""A pose that nobody measured is not planned for."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Header

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.recipes.documents import shipped_recipes
from support.path_generator_node import active_generator

DOOR = "thesis_190_0deg"


@pytest.fixture
def generator() -> Iterator[PathGenerator]:
    with active_generator() as node:
        yield node


def pose(ahead: float) -> PoseStamped:
    recipe = shipped_recipes()[DOOR]
    message = PoseStamped(pose=pose_message(load_layout().T_base_door(recipe.width, recipe.thickness)))
    nanoseconds = time.time_ns() + int(ahead * 1e9)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return message


def take_recipe(node: PathGenerator, ahead: float = 0.0) -> None:
    header = Header(stamp=pose(ahead).header.stamp)
    node._take_recipe(recipe_message(shipped_recipes()[DOOR], "r1", header))


@pytest.mark.parametrize("known", [False, True], ids=["before the recipe", "after the recipe"])
def test_a_pose_from_the_future_is_left_aside(generator: PathGenerator, known: bool) -> None:
    if known:
        take_recipe(generator)
    generator._take_pose(pose(3600.0))
    if not known:
        take_recipe(generator)
    assert generator._targets.messages == []
    assert "in the future" in generator._health[1]
    generator._take_pose(pose(0.0))
    (answer,) = generator._targets.messages
    assert (answer.run_id, answer.accepted) == ("r1", True)


def test_a_recipe_of_before_the_clock_was_set_back_does_not_hold_its_door_up(
    generator: PathGenerator,
) -> None:
    take_recipe(generator, 3600.0)
    generator._take_pose(pose(0.0))
    (answer,) = generator._targets.messages
    assert (answer.run_id, answer.accepted) == ("r1", True)


def test_a_pose_that_overtakes_its_recipe_waits_for_it(generator: PathGenerator) -> None:
    early = pose(-0.1)
    take_recipe(generator)
    generator._take_pose(early)
    assert generator._targets.messages == []
