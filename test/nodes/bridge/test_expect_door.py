"""The service that tells the robot which door is being loaded, as a bar code reader calls it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_interfaces.srv import ExpectDoor
from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import DoorNameError
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.bridge import expect_door
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.controller.controller import VirtualController
from support.rapid_bench import arm  # noqa: F401
from support.waiting import LIMIT

DOOR = "standard_door"
CODE = load_recipe(DOOR).bar_code

Ask = Callable[..., ExpectDoor.Response]


@pytest.fixture
def ask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Ask]:
    """Calls the service of a bridge on a folder, with the shipped recipes in the database."""
    monkeypatch.setattr(expect_door, "LIMIT", LIMIT)  # a loaded machine must not decide
    url = f"sqlite:///{tmp_path / 'recipes.db'}"
    context = rclpy.Context()
    rclpy.init(context=context)
    (tmp_path / "home").mkdir()
    bridge = {"transport": "simulated_folder", "address": str(tmp_path / "home"), "archive": str(tmp_path)}
    recipes = {"database_url": url, "ship_recipes": True}
    nodes = [
        kind(context=context, parameter_overrides=[Parameter(n, value=v) for n, v in values.items()])
        for kind, values in ((AbbBridge, bridge), (RecipeDatabaseNode, recipes))
    ]
    client_node = rclpy.create_node("bar_code_reader", context=context)
    executor = SteadyExecutor(4, context=context)
    for node in (*nodes, client_node):
        executor.add_node(node)
    for node in nodes:
        assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
        assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    client = client_node.create_client(ExpectDoor, "abb/expect_door")
    assert client.wait_for_service(LIMIT)

    def ask_(**fields: str) -> ExpectDoor.Response:
        answered = threading.Event()
        future = client.call_async(ExpectDoor.Request(**fields))
        future.add_done_callback(lambda _: answered.set())
        assert answered.wait(LIMIT)
        return future.result()

    yield ask_
    executor.shutdown()
    spinning.join()
    for node in nodes:
        node.close()
    for node in (*nodes, client_node):
        node.destroy_node()
    rclpy.shutdown(context=context)


def expected(tmp_path: Path) -> str:
    path = tmp_path / "home" / signals.EXPECTED_FILE
    return path.read_text() if path.exists() else ""


def test_a_door_is_named_by_its_id_or_its_bar_code(ask: Ask, tmp_path: Path) -> None:
    answer = ask(door_id="thesis_190_0deg")
    assert (answer.success, answer.error_code, answer.door_id) == (True, 0, "thesis_190_0deg")
    assert expected(tmp_path) == "thesis_190_0deg\n#end\n"
    answer = ask(bar_code=CODE)
    assert (answer.success, answer.error_code, answer.door_id) == (True, 0, DOOR)
    assert expected(tmp_path) == f"{DOOR}\n#end\n"


@pytest.mark.parametrize(
    ("fields", "code", "words"),
    [
        ({}, DoorNameError.code, "exactly one"),
        ({"door_id": DOOR, "bar_code": CODE}, DoorNameError.code, "exactly one"),
        ({"door_id": "d" * 41}, DoorNameError.code, "1 to 40"),
        ({"door_id": "Tür"}, DoorNameError.code, "Tür"),
        ({"bar_code": "0000000000000"}, None, "0000000000000"),
    ],
)
def test_a_door_that_cannot_be_named_leaves_the_robot_without_a_name(
    ask: Ask, tmp_path: Path, fields: dict[str, str], code: int | None, words: str
) -> None:
    answer = ask(**fields)
    assert not answer.success
    assert answer.error_code == code or (code is None and 100 <= answer.error_code < 200)
    assert words in answer.message
    assert expected(tmp_path) == ""


def test_the_robot_program_takes_the_name_once_and_asks_for_that_door_alone(
    ask: Ask,
    tmp_path: Path,
    arm,  # noqa: F811
) -> None:
    """With the program waiting for a name, until it has asked for a path."""
    answers: list[bool] = []

    def plant(robot: VirtualController) -> None:
        if not answers:
            answers.append(ask(bar_code=CODE).success)
        if robot.io.read(signals.REQUEST):
            robot.stop()

    robot = VirtualController(tmp_path / "home", arm, on_wait=plant)
    robot.panel.start()
    robot.serve()
    assert answers == [True]
    assert robot.io.read(signals.REQUEST) == 1
    assert robot.program.read("expectedDoor") == DOOR
    assert expected(tmp_path) == ""
