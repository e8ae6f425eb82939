"""Ten doors from aravis' fake camera in a cell of processes: packets get lost, the camera restarts and is unplugged."""

from __future__ import annotations

import re
import threading
from pathlib import Path

import numpy as np
import pytest
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.gige.errors import NoPictureInTime
from doormill_ros.localization.gige.exposure import EdgeLight
from doormill_ros.localization.view import face_view
from doormill_ros.nodes.base import topics
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from support.cell_processes import NODES, PATIENT, CellProcesses
from support.gige.fake_camera import ADDRESS, FakeCamera

DOOR = "thesis_190_0deg"
RECIPE = shipped_recipes()[DOOR]
DOORS = 10
RESTARTED, UNPLUGGED, BY_HAND = 4, 7, 9
#: Two in five pictures lack a packet.
PACKET, LOST = 8000, 0.002
OFFSETS = np.random.default_rng(12).uniform(-0.006, 0.006, (DOORS, 2))
TURN = 0.002
#: Shares of the light for which the first exposure is right.
LIGHT = np.resize([0.1, 1.0, 0.3], DOORS)


def picture_of_a_door(number: int) -> np.ndarray:
    offset = DoorOffset(*OFFSETS[number], TURN)
    seen = render_picture(PictureScene(RECIPE.width, RECIPE.thickness, offset), number)
    return np.rint(seen * LIGHT[number]).astype(np.uint8)


def put(cell: CellProcesses, node: str, **values: float) -> None:
    """Change parameters of a running node."""
    parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
    request = SetParameters.Request(parameters=parameters)
    answer = cell.ask(SetParameters, f"{node}/set_parameters", request)
    assert all(r.successful for r in answer.results)


def told(diagnostics: list) -> list[tuple[str, dict[str, str]]]:
    """Messages and values of the camera's node since the list began."""
    own = [s for message in list(diagnostics) for s in message.status if s.name.endswith("gige_camera")]
    return [(status.message, {value.key: value.value for value in status.values}) for status in own]


def test_ten_doors_are_milled_over_a_lossy_line(tmp_path: Path) -> None:
    camera = FakeCamera(tmp_path / "scene.npy", LOST)
    camera.show(picture_of_a_door(0))
    parameters = {
        "cell_simulator": {"camera_simulator:pictures": False},
        "gige_camera": {"address": ADDRESS, "packet_size": PACKET, "limit": PATIENT["limit.picture"]},
    }
    nodes = ("gige_camera", *(name for name in NODES if name != "bag_recorder"))
    results = []
    with camera, CellProcesses(tmp_path / "cell", parameters, nodes) as cell:
        found = cell.subscribe(topics.DOOR_LOCALIZATION)
        diagnostics = cell.subscribe(topics.DIAGNOSTICS)
        process = cell.processes["gige_camera"]
        for number in range(DOORS):
            # The door that is really milled stands where the camera sees it.
            y, z = OFFSETS[number].tolist()
            put(cell, "camera_simulator", offset_y=y, offset_z=z, offset_rotation=TURN)
            camera.show(picture_of_a_door(number))
            if number == BY_HAND:
                put(cell, "gige_camera", exposure_auto=False, exposure=0.05, gain=6.0)
            if number == RESTARTED:
                camera.unplug()
                camera.plug()
            if number != UNPLUGGED:
                results.append(cell.mill(DOOR)[0])
                continue
            camera.unplug()
            diagnostics.clear()
            mill = threading.Thread(target=lambda: results.append(cell.mill(DOOR)[0]))
            mill.start()
            cell.wait(
                lambda: any(f"camera {ADDRESS} does not answer" in said for said, _ in told(diagnostics))
            )
            assert len(results) == UNPLUGGED
            camera.plug()
            mill.join()
        assert process.poll() is None
        by_hand = cell.wait(lambda: [v for _, v in told(diagnostics) if v.get("exposure") == "0.050000"])
        log = cell.log("gige_camera")
    assert [result.success for result in results] == [True] * DOORS, [r.message for r in results]
    accepted = {answer.run_id: answer for answer in found if answer.accepted}
    assert len(accepted) == DOORS
    places = np.array([[answer.offset_y, answer.offset_z] for answer in accepted.values()])
    assert np.abs(places - OFFSETS).max() < 1e-4
    values = {key: float(value) for key, value in by_hand[-1].items()}
    assert values["lost"] > 0, "no packet was lost"
    assert values["reached"] >= 3, "the camera was not reached anew"
    rendered = EdgeLight(
        face_view(load_camera(), load_layout(), RECIPE.width, RECIPE.thickness), load_layout().limits
    )
    assert values["light"] == pytest.approx(
        rendered.level(picture_of_a_door(BY_HAND)) * 5 * 10**0.3, rel=0.05
    )
    assert "Traceback" not in log


def test_a_door_before_an_unplugged_camera_is_refused_with_the_reason(tmp_path: Path) -> None:
    camera = FakeCamera(tmp_path / "scene.npy")
    camera.show(picture_of_a_door(0))
    parameters = {
        "cell_simulator": {"camera_simulator:pictures": False},
        "gige_camera": {"address": ADDRESS, "packet_size": PACKET},
    }
    nodes = ("gige_camera", *NODES)
    with camera, CellProcesses(tmp_path / "cell", parameters, nodes) as cell:
        found = cell.subscribe(topics.DOOR_LOCALIZATION)
        y, z = OFFSETS[0].tolist()
        put(cell, "camera_simulator", offset_y=y, offset_z=z, offset_rotation=TURN)
        assert cell.mill(DOOR)[0].success
        camera.unplug()
        refused = cell.mill(DOOR)[0]
        camera.plug()
        put(cell, "gige_camera", limit=PATIENT["limit.picture"])
        again = cell.mill(DOOR)[0]
    assert not refused.success
    assert refused.error_code == NoPictureInTime.code
    assert re.search(r"no picture of the door came within [\d.]+ s: .*check its cable", refused.message)
    (answer,) = [one for one in found if one.error_code == NoPictureInTime.code]
    assert answer.run_id == refused.run_id
    assert again.success, again.message
