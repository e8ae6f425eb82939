"""Every refusal: a sentence, a code, no target file, ready low, no dead node, and the next door runs."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import yaml
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from doormill_interfaces.srv import ImportRecipes
from doormill_ros.nodes.base import topics
from doormill_ros.recipes.documents import shipped_recipes
from support.cell_processes import PATIENT, CellProcesses

GOOD_DOOR = "thesis_190_0deg"
UNSET = 999.0


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    with CellProcesses(tmp_path_factory.mktemp("cell")) as running:
        running.ready = running.subscribe(topics.ABB_READY)
        yield running


def set_parameters(cell: CellProcesses, node: str, values: dict[str, Any]) -> None:
    parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
    request = SetParameters.Request(parameters=parameters)
    answer = cell.ask(SetParameters, f"{node}/set_parameters", request)
    assert all(r.successful for r in answer.results)


def refused(cell: CellProcesses, door: str, code: int | tuple[int, int], *words: str) -> None:
    """Mill a door that must be refused, then one that must not."""
    result, _ = cell.mill(door)
    assert not result.success
    low, high = (code, code) if isinstance(code, int) else code
    assert low <= result.error_code <= high, result.message
    for word in words:
        assert word in result.message, result.message
    assert result.target_file == ""
    assert result.sha256 == ""
    home = cell.folder / "HOME"
    cell.wait(lambda: not (home / "Hei2.txt").exists())
    assert (home / "io" / "doPathReady").read_text() == "0"
    cell.wait(lambda: cell.ready and not cell.ready[-1].data)
    assert all(process.poll() is None for process in cell.processes.values())


def still_mills(cell: CellProcesses) -> None:
    result, _ = cell.mill(GOOD_DOOR)
    assert result.success, result.message


def test_unknown_door(cell: CellProcesses) -> None:
    refused(cell, "no_such_door", 140, "no_such_door")
    still_mills(cell)


@contextmanager
def impatient(cell: CellProcesses, stage: str) -> Iterator[None]:
    """Shorten the wait for the stage that is known not to come; the others take the time they need."""
    limit = f"limit.{stage}"
    set_parameters(cell, "abb_bridge", {limit: 3.0})
    yield
    set_parameters(cell, "abb_bridge", {limit: PATIENT[limit]})


def test_no_picture(cell: CellProcesses) -> None:
    set_parameters(cell, "camera_simulator", {"pictures": False})
    with impatient(cell, "picture"):
        refused(cell, GOOD_DOOR, 801, "no picture", "camera/image_raw")
    set_parameters(cell, "camera_simulator", {"pictures": True})
    still_mills(cell)


@pytest.mark.parametrize(
    ("offset", "words"),
    [
        ({"offset_y": 0.0125}, ("mm", "10")),
        ({"offset_z": -0.0125}, ("mm", "10")),
        ({"offset_rotation": 0.041}, ("degrees", "2")),
    ],
)
def test_door_outside_the_placement_limits(
    cell: CellProcesses, offset: dict[str, float], words: tuple[str, ...]
) -> None:
    set_parameters(cell, "camera_simulator", offset)
    refused(cell, GOOD_DOOR, 204, *words)
    set_parameters(cell, "camera_simulator", dict.fromkeys(offset, UNSET))
    still_mills(cell)


def test_unreachable_target(cell: CellProcesses, tmp_path: Any) -> None:
    """A lock case 2.9 m up on the far edge of the widest door is out of the robot's reach."""
    document = shipped_recipes()["standard_door"].to_document()
    document |= {
        "door_id": "too_far",
        "bar_code": "too-far",
        "width_mm": 1350,
        "height_mm": 3000,
        "mass_kg": 90,
    }
    for feature in document["features"]:
        if feature["kind"] == "lock_case":
            feature["height_mm"] = 2750
    document["features"] = [f for f in document["features"] if f["kind"] == "lock_case"]
    document["tools"] = {f["tool"]: document["tools"][f["tool"]] for f in document["features"]}
    path = tmp_path / "too_far.yaml"
    path.write_text(yaml.safe_dump(document))
    answer = cell.ask(ImportRecipes, "recipes/import", ImportRecipes.Request(path=str(path), author="test"))
    assert answer.success, answer.message
    refused(cell, "too_far", (300, 399), "lock_case")
    still_mills(cell)


def test_a_second_goal_is_refused_while_a_door_is_milled(cell: CellProcesses) -> None:
    answers: list[Any] = []
    threads = [threading.Thread(target=lambda: answers.append(cell.mill(GOOD_DOOR)[0])) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(a.success for a in answers) == [False, True]
    (busy,) = (a for a in answers if not a.success)
    assert busy.error_code == 802
    still_mills(cell)
