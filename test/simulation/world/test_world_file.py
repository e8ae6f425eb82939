"""A world file says what differs; the rest is as the project assumes."""

import numpy as np
import pytest

from doormill_ros.resources import resource
from doormill_ros.simulation.errors import WorldFileError
from doormill_ros.simulation.world.world_file import load_world


@pytest.fixture
def world(tmp_path):
    def load(text):
        path = tmp_path / "world.yaml"
        path.write_text(f"schema: doormill/world/1\n{text}\n", encoding="utf-8")
        return load_world(path)

    return load


def test_what_is_left_out_is_as_the_project_assumes(world):
    door = world("").door(7)
    assert door.robot.stiffness_factor == (1.0,) * 6
    assert door.robot.gap == (0.0,) * 6
    assert (door.robot.pose_error.size, door.tool.mass, door.links.masses) == (0.0, 0.0, ())
    assert door.tool.stiffness is None
    assert (door.force.law, door.force.factor, door.force.angle) == ("recipe", 1.0, 0.0)
    assert (door.force.wear_per_door, door.force.scatter) == (0.0, 0.0)
    assert not np.any([door.camera.moved, door.camera.turned, door.clamp.shift])
    assert (door.temperature.rise, door.temperature.growth) == (0.0, 0.0)
    assert (door.controller.segment_time, door.controller.acceleration) == (None, None)
    assert door.controller.corner == 0.0


def test_the_shipped_example_holds_the_keys_of_the_contract():
    world = load_world(resource("config/worlds/example.yaml"))
    before, after = world.door(11), world.door(12)
    assert world.seed == 1
    assert before.robot.gap == (0.0,) * 6
    assert after.robot.gap == (1e-4, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert after.robot.stiffness_factor == (1.0, 1.0, 0.7, 1.0, 1.0, 1.0), "a change leaves the other keys"
    assert (after.robot.crossing, after.robot.pose_error.seed) == (5.0, 3)
    assert after.tool.stiffness == 1.2e6


def test_changes_add_up_in_the_order_of_the_file(world):
    shift = world(
        "robot: {pose_error: {seed: 3, size: 1.0e-4}}\n"
        "change:\n"
        "  - {from_door: 2, force: {factor: 1.2}}\n"
        "  - {from_door: 4, force: {angle: 0.1}, robot: {pose_error: {size: 2.0e-4}}}\n"
        "  - {from_door: 6, force: {factor: 1.0}}"
    )
    found = [
        (door.force.factor, door.force.angle, door.robot.pose_error.size)
        for door in map(shift.door, (0, 2, 4, 6))
    ]
    assert found == [(1.0, 0.0, 1e-4), (1.2, 0.0, 1e-4), (1.2, 0.1, 2e-4), (1.0, 0.1, 2e-4)]
    assert shift.door(6).robot.pose_error.seed == 3


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("weather: {}", "weather is unknown, allowed are robot, tool, links"),
        (
            "robot: {gaps: 1}",
            "robot.gaps is unknown, allowed are stiffness_factor, gap, crossing, pose_error",
        ),
        (
            "change: [{from_door: 1, robot: {gaps: 1}}]",
            "change.0.robot.gaps is unknown, allowed are stiffness_f",
        ),
        ("change: [{robot: {crossing: 1}}]", "change.0.from_door is missing"),
        ("change: [{from_door: 1, seed: 2}]", "change.0.seed is unknown"),
        ("robot: {gap: [0, 0, 0, 0, 0, -1]}", "robot.gap.5 is -1, allowed is a number from 0 up"),
        (
            "robot: {stiffness_factor: [0, 1, 1, 1, 1, 1]}",
            "robot.stiffness_factor.0 is 0, allowed is a positive",
        ),
        ("force: {law: wood}", "force.law is 'wood', allowed is 'recipe' or 'engagement'"),
        ("tool: {stiffness: 0}", "tool.stiffness is 0, allowed is a positive number"),
        ("clamp: {shift: [1, 2]}", "clamp.shift is [1, 2], allowed are 3 finite numbers"),
        ("links: {masses: [1, 1, 1, 1, 1, 1, 1]}", "links.masses holds 7 numbers, allowed are at most 6"),
        ("seed: -1", "seed is -1, allowed is a whole number from 0 up"),
    ],
)
def test_what_is_not_allowed_is_refused_with_file_key_and_advice(world, tmp_path, text, complaint):
    with pytest.raises(WorldFileError) as caught:
        world(text)
    assert caught.value.code == 857
    assert caught.value.message.startswith(f"{tmp_path / 'world.yaml'}: {complaint}")
    assert caught.value.message.endswith("compare it with docs/world.md")


def test_another_schema_is_refused(tmp_path):
    path = tmp_path / "world.yaml"
    path.write_text("schema: doormill/world/2\n", encoding="utf-8")
    with pytest.raises(WorldFileError, match="schema is 'doormill/world/2', allowed is doormill/world/1"):
        load_world(path)
