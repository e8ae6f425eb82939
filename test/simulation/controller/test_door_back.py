"""Out of the wood after a stop in the cut: through what the tool cut, back along its path."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError

#: A retreat may be so far beside the path [m]: corners are passed in zones of 0.3 mm.
BESIDE = 0.5e-3
COPY = "Hei2.cut"
HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]


@pytest.fixture
def lost(door, controller):
    """A robot whose spindle was lost in a cutting motion of a door, and the samples up to its standing."""

    def lost_(name: str, motion: int):
        robot = controller(patience=None)
        (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door(name), "run-1"))
        happened = []

        def watch(c):
            if not happened and c.moving and c.program.read("millingMotion") >= motion and c.context.cutting:
                happened.append(c.context.index)
                c.cell.set_input("diSpindleAtSpeed", 0.0)

        robot._on_time = watch
        robot.run()
        assert happened
        return robot, robot.executed_count

    return lost_


def led_back(robot) -> list[tuple[str, ...]]:
    """What the operator was asked while main began anew; he takes the first answer, three times at most."""
    asked: list[tuple[str, ...]] = []

    def operator(dialog):
        asked.append(dialog.lines)
        if len(asked) == 3:
            robot.stop()
        return dialog.buttons[0][0]

    robot.teach_pendant.operator = operator
    robot._on_time = lambda c: c.program.read("doorInHand") is False and c.stop()
    robot.clamped = 1.0
    with pytest.raises(RapidStoppedError, match="stopped from outside"):
        robot.run(reset=False)
    return asked


def beside_the_path(robot, stood: int, name: str) -> np.ndarray:
    """Distances [m] from the way there of all samples of the way back that are in the door."""
    recipe = load_recipe(name)
    T = load_layout().T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
    tips = np.array([pose[:3, 3] for pose in robot._engine.recording.poses])
    own = (tips - T[:3, 3]) @ T[:3, :3]
    size = np.array([recipe.thickness, recipe.width, recipe.size.height])
    back = tips[stood:][((own[stood:] > 0.0) & (own[stood:] < size)).all(axis=1)]
    start, way = tips[: stood - 1], np.diff(tips[:stood], axis=0)
    length = np.maximum(np.einsum("ni,ni->n", way, way), 1e-18)
    share = np.clip(np.einsum("mni,ni->mn", back[:, None] - start, way) / length, 0.0, 1.0)
    foot = start + share[..., None] * way
    return np.linalg.norm(back[:, None] - foot, axis=2).min(axis=1)


@pytest.mark.parametrize(
    ("name", "motion"),
    [
        ("thesis_190_0deg", 5),  # in the first arc
        ("thesis_190_0deg", 8),  # round the slot
        ("thesis_190_0deg", 14),  # the other hinge
        ("nine_point_door", 8),  # the first level
        ("nine_point_door", 24),  # deeper, past rings
        ("nine_point_door", 55),
    ],
)
@pytest.mark.parametrize("pointer", ["stays", "goes to main"])
def test_a_tool_that_stands_leaves_the_wood_where_it_came_in(lost, name, motion, pointer):
    robot, stood = lost(name, motion)
    if pointer == "goes to main":
        robot.program.write("moveCount", "0")  # with the variables the path is gone
        robot.program.write("runId", '""')
    asked = led_back(robot)
    assert [lines[-1] for lines in asked] == [
        "Retract and go home?",
        "This door is spoilt. Go on with the next.",
    ]
    assert np.allclose(np.degrees(robot.q), HOME, atol=1e-3)
    beside = beside_the_path(robot, stood, name)
    assert len(beside) > 2
    assert beside.max() < BESIDE


def test_a_way_back_that_nobody_knows_is_jogged(lost):
    """Pointer at main and no copy of the file: nothing moves."""
    robot, stood = lost("thesis_190_0deg", 5)
    robot.program.write("moveCount", "0")
    (robot.home / COPY).unlink()
    asked = led_back(robot)
    assert {lines[-1] for lines in asked} == {"Jog it clear of the door and run MoveHome."}
    assert robot.executed_count == stood


def test_the_copy_of_another_door_is_no_way_back(lost, door):
    robot, stood = lost("thesis_190_0deg", 5)
    robot.program.write("moveCount", "0")
    (robot.home / COPY).write_bytes(render_target_file(door("nine_point_door"), "run-0"))
    led_back(robot)
    assert robot.executed_count == stood
