"""Ten doors from aravis' fake camera in a cell of processes: packets get lost, the camera restarts and is unplugged."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from doormill_ros.cell.layout import DoorOffset
from doormill_ros.nodes import topics
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from support.cell_processes import NODES, CellProcesses
from support.gige.fake_camera import ADDRESS, FakeCamera

DOOR = "thesis_190_0deg"
DOORS = 10
RESTARTED, UNPLUGGED = 4, 7
#: Two in five pictures lack a packet.
PACKET, LOST = 8000, 0.002
OFFSETS = np.random.default_rng(12).uniform(-0.006, 0.006, (DOORS, 2))
TURN = 0.002
#: Shares of the light for which the first exposure is right.
LIGHT = np.resize([0.1, 1.0, 0.3], DOORS)


def picture_of_a_door(number: int) -> np.ndarray:
    recipe = shipped_recipes()[DOOR]
    offset = DoorOffset(*OFFSETS[number], TURN)
    seen = render_picture(PictureScene(recipe.width, recipe.thickness, offset), number)
    return np.rint(seen * LIGHT[number]).astype(np.uint8)


def stand(cell: CellProcesses, number: int) -> None:
    """The door that is really milled stands where the camera sees it."""
    y, z = OFFSETS[number].tolist()
    values = {"offset_y": y, "offset_z": z, "offset_rotation": TURN}
    parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
    request = SetParameters.Request(parameters=parameters)
    answer = cell.ask(SetParameters, "camera_simulator/set_parameters", request)
    assert all(r.successful for r in answer.results)


def said(diagnostics: list, what: str) -> bool:
    """The camera's node said so since the list began."""
    own = (s for message in list(diagnostics) for s in message.status if s.name.endswith("gige_camera"))
    return any(what in status.message for status in own)


def test_ten_doors_are_milled_over_a_lossy_line(tmp_path: Path) -> None:
    camera = FakeCamera(tmp_path / "scene.npy", LOST)
    camera.show(picture_of_a_door(0))
    parameters = {
        "cell_simulator": {"camera_simulator:pictures": False},
        "gige_camera": {"address": ADDRESS, "packet_size": PACKET},
    }
    nodes = ("gige_camera", *(name for name in NODES if name != "bag_recorder"))
    results = []
    with camera, CellProcesses(tmp_path / "cell", parameters, nodes) as cell:
        found = cell.subscribe(topics.DOOR_LOCALIZATION)
        diagnostics = cell.subscribe(topics.DIAGNOSTICS)
        process = cell.processes["gige_camera"]
        for number in range(DOORS):
            stand(cell, number)
            camera.show(picture_of_a_door(number))
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
            cell.wait(lambda: said(diagnostics, f"camera {ADDRESS} does not answer"))
            assert len(results) == UNPLUGGED
            camera.plug()
            mill.join()
        assert process.poll() is None
        last = [s for m in diagnostics for s in m.status if s.name.endswith("gige_camera")][-1]
        log = cell.log("gige_camera")
    assert [result.success for result in results] == [True] * DOORS, [r.message for r in results]
    accepted = {answer.run_id: answer for answer in found if answer.accepted}
    assert len(accepted) == DOORS
    places = np.array([[answer.offset_y, answer.offset_z] for answer in accepted.values()])
    assert np.abs(places - OFFSETS).max() < 1e-4
    values = {value.key: int(value.value) for value in last.values if value.key in ("lost", "reached")}
    assert values["lost"] > 0, "no packet was lost"
    assert values["reached"] >= 3, "the camera was not reached anew"
    assert "Traceback" not in log
