"""Sensors beside and instead of the camera: real nodes, simulated readings, a door, and what stops it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorRecipe, SensorReading
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.cell.run.run import StageLimits
from doormill_ros.localization.sensors.errors import BadReading, BeamMissed, SensorsDisagree
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.one_process.cell import Cell, CellOptions, run_once
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS
from doormill_ros.units import DEG, MM
from support.cell_processes import NODES, PATIENT, CellProcesses

DOOR = "thesis_190_0deg"
LATE = 12.0  # s, longer than a run of separate nodes waits for a picture
#: Three standard deviations of y, z and rotation by docs/sensors.md; of the probe what its arm's scatter leaves.
NEAR = {
    "axis_vision": np.array([0.03 * MM, 0.03 * MM, 0.016 * DEG]),
    "photoelectric": np.array([0.12 * MM, 0.12 * MM, 0.025 * DEG]),
    "touch_probe": np.array([0.25 * MM, 0.25 * MM, 0.02 * DEG]),
}
#: On a door 190 mm wide the probe's points on the face are 90 mm apart, and the hinges' depth suffers.
WIDE = {"touch_probe": "standard_door"}


def options(*sensors: str, **parameters: dict[str, Any]) -> CellOptions:
    return CellOptions({"abb_bridge": dict(PATIENT), **parameters}, sensors=sensors)


def bag_of(summary: RunSummary) -> dict[str, list[Any]]:
    """Messages by topic."""
    found: dict[str, list[Any]] = {}
    for item in read_bag(Path(summary.bag)):
        found.setdefault(item.topic.lstrip("/"), []).append(item.message)
    return found


def test_a_simulated_sensor_that_is_slow_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A busy machine draws its pictures late; that turns no good door into a refused one."""
    true = SIMULATED_SENSORS["photoelectric"]()

    class Late:
        def sense(self, *door: Any) -> Any:
            time.sleep(LATE)
            return true.sense(*door)

    monkeypatch.setitem(SIMULATED_SENSORS, "photoelectric", Late)
    alive = {"limit.sign_of_life": PATIENT["limit.sign_of_life"]}
    chosen = CellOptions({"abb_bridge": alive}, sensors=("photoelectric",))
    summary = run_once(DOOR, tmp_path, chosen)
    assert summary.success, summary.message
    assert summary.times.request_to_ready > StageLimits().picture


@pytest.mark.parametrize("sensor", sorted(SIMULATED_SENSORS))
def test_a_door_is_milled_by_each_sensor_instead_of_the_camera(sensor: str, tmp_path: Path) -> None:
    summary = run_once(WIDE.get(sensor, DOOR), tmp_path, options(sensor))
    assert summary.success, summary.message
    error = summary.localization_error
    assert np.all(np.abs([error.y, error.z, error.rotation]) < NEAR[sensor])
    assert any((error.y, error.z, error.rotation))
    found = bag_of(summary)
    assert {message.sensor for message in found[topics.SENSOR_READING.name]} == {sensor}
    assert topics.IMAGE.name not in found
    assert topics.SENSOR_LOCALIZATION.name not in found  # nothing to be compared with
    assert replay_bag(Path(summary.bag)).found == []


def test_sensors_beside_each_other_that_agree_let_the_door_pass(tmp_path: Path) -> None:
    summary = run_once(DOOR, tmp_path, options(CAMERA, "touch_probe"))
    assert summary.success, summary.message
    found = bag_of(summary)
    told = {message.sensor: message for message in found[topics.SENSOR_LOCALIZATION.name]}
    assert set(told) == {CAMERA, "touch_probe"}
    assert list(told[CAMERA].sees) == [False, True, True, True, False, False]
    assert all(told["touch_probe"].sees)
    # Milled is from the first one's pose.
    (pose, *_) = found[topics.DOOR_POSE.name]
    assert pose.pose == told[CAMERA].pose.pose
    assert pose.pose != told["touch_probe"].pose.pose
    assert replay_bag(Path(summary.bag)).found == []


def test_executables_beside_each_other_mill_a_door_found_by_two_sensors(tmp_path: Path) -> None:
    chosen = f"photoelectric,{CAMERA}"
    parameters = {
        "door_localizer": {"sensors": chosen},
        "abb_bridge": {"sensors": chosen},
        "door_sensors": {f"{name}:sensors": chosen for name in CELL_SENSORS},
        "cell_simulator": {f"{name}:sensors": chosen for name in ("camera_simulator", "sensor_simulator")},
    }
    with CellProcesses(tmp_path, parameters, (*NODES, "door_sensors")) as cell:
        for name in CELL_SENSORS:
            cell.wait_until_active(name)
        told = cell.subscribe(topics.SENSOR_LOCALIZATION)
        result, stages = cell.mill(DOOR)
        assert result.success, result.message
        cell.wait(lambda: {message.sensor for message in told} == {"photoelectric", CAMERA})
        assert {message.run_id for message in told} == {result.run_id}
        assert "milling" in stages
        for name in list(cell.processes):
            assert "Traceback" not in cell.log(name), cell.log(name)


def test_a_camera_that_is_off_by_half_a_millimetre_stops_the_door(tmp_path: Path) -> None:
    world = tmp_path / "world.yaml"
    world.write_text("schema: doormill/world/1\ncamera: {moved: [0.0, 0.0005, 0.0]}\n")
    folder = RunFolder(tmp_path / "run")
    chosen = options(CAMERA, "photoelectric", camera_simulator={"world": str(world)})
    summary = run_once(DOOR, folder.root, chosen)
    assert summary.error_code == SensorsDisagree.code
    assert not summary.success
    for part in ("camera and photoelectric", "standard deviations", "y +0."):
        assert part in summary.message
    assert summary.target_file == ""
    assert list(folder.targets.glob("*.txt")) == []
    found = bag_of(summary)
    assert not any(message.data for message in found[topics.ABB_READY.name])
    (result,) = found[topics.RUN_RESULT.name]
    assert (result.error_code, result.message) == (SensorsDisagree.code, summary.message)
    camera, beams = (
        next(m.pose.pose.position for m in found[topics.SENSOR_LOCALIZATION.name] if m.sensor == name)
        for name in (CAMERA, "photoelectric")
    )
    assert beams.y - camera.y == pytest.approx(0.5 * MM, abs=NEAR["photoelectric"][0])
    assert replay_bag(Path(summary.bag)).found == []


class Driver:
    """Plays a sensor's driver in a running cell; what it sends is chosen by `make`."""

    def __init__(self, cell: Cell) -> None:
        self.make: Callable[[SensorReading], SensorReading | None] = lambda reading: None
        self._recipe: DoorRecipe | None = None
        self._node = cell._composition.driver
        topic = topics.SENSOR_READING
        self._publisher = self._node.create_publisher(topic.type, topic.name, topic.offered)
        recipe = topics.DOOR_RECIPE
        self._node.create_subscription(recipe.type, recipe.name, self._take, recipe.requested)
        self._node.create_timer(0.2, self._send)

    def _take(self, recipe: DoorRecipe) -> None:
        self._recipe = recipe

    def _send(self) -> None:
        if self._recipe is None:
            return
        header = Header(stamp=self._node.get_clock().now().to_msg())
        reading = self.make(SensorReading(header=header, sensor="photoelectric", run_id=self._recipe.run_id))
        if reading is not None:
            self._publisher.publish(reading)


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Cell, Driver]]:
    """A cell beside whose camera the beams' driver is the test's own."""
    folder = RunFolder(tmp_path_factory.mktemp("hostile"))
    folder.prepare()
    limits = {**PATIENT, "limit.picture": 5.0}
    chosen = CellOptions(
        {"abb_bridge": limits, "sensor_simulator": {"sensors": CAMERA}}, sensors=("photoelectric",)
    )
    with Cell(folder, chosen) as cell:
        yield cell, Driver(cell)


def with_distances(reading: SensorReading, *distances: float) -> SensorReading:
    reading.distances = list(distances)
    return reading


def with_points(reading: SensorReading) -> SensorReading:
    reading.points = [Point()] * 6
    return reading


def of_another_run(reading: SensorReading) -> SensorReading:
    reading.run_id = "20200101T000000000000Z"
    return with_distances(reading, *[0.055] * 6)


def of_another_sensor(reading: SensorReading) -> SensorReading:
    reading.sensor = "no_such_sensor"
    return with_distances(reading, *[0.055] * 6)


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda reading: with_distances(reading, *[float("nan")] * 6), BeamMissed.code),
        (lambda reading: with_distances(reading, *[float("inf")] * 6), BeamMissed.code),
        (lambda reading: with_distances(reading, *[0.055] * 5), BadReading.code),
        (lambda reading: reading, BadReading.code),
        (with_points, BadReading.code),
        (of_another_run, StageTimeoutError.code),
        (of_another_sensor, StageTimeoutError.code),
        (lambda reading: None, StageTimeoutError.code),
    ],
    ids=["nan", "infinite", "too few", "empty", "another kind", "another run", "another sensor", "never"],
)
def test_readings_of_no_use_end_the_run_in_time_with_the_sensor_named(
    hostile: tuple[Cell, Driver], make: Callable[[SensorReading], SensorReading | None], code: int
) -> None:
    cell, driver = hostile
    driver.make = make
    summary = cell.mill(DOOR)
    assert summary.error_code == code, summary.message
    assert "photoelectric" in summary.message
    assert summary.target_file == ""


def test_after_all_of_them_the_next_door_is_found(hostile: tuple[Cell, Driver]) -> None:
    """A door in its nominal place has every beam at its stand-off."""
    cell, driver = hostile
    driver.make = lambda reading: with_distances(reading, *[0.055] * 6)
    summary = cell.mill(DOOR)
    assert summary.target_file, summary.message
