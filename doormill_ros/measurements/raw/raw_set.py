"""A folder of raw loading tests: one YAML that says which file was recorded where, and the files.

schema: doormill/raw-loading-tests/1
robot: irb6600_175_255
wrench_frame_rotation: 0.76878      # rad, sensor axes to flange axes about the flange z
load_point: [0.0, 0.0, 0.18]        # m, flange frame; the readings are the wrench at this point
tracker_rotation: [0.0, 0.0, 0.0]   # rotation vector [rad] from tracker axes to base axes; may be left out
noise: {displacement: 4.0e-6, force: 0.3, torque: 0.03}   # what a repeated test scatters beside its mean
tests:
  - name: joint1
    q: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]                     # rad
    force: {loaded: force_1.csv, unloaded: force_0.csv}    # the unloaded log may be left out
    reflectors:
      - {link: 1, position: [0.12, 0.0, 0.48], unloaded: FARO_0a.txt, loaded: FARO_1a.txt}
  - name: joint2                                           # a load that bypasses the sensor
    q: [0.0, 0.0, -0.5236, 0.0, 0.0, 0.0]
    load: {link: 2, point: [0.0, 0.0, 0.0], force: [197.0, 0.0, 0.0]}   # link frame; force in base axes, N
    reflectors: [...]
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import rotate_wrench, rotation_from_vector, rotation_z
from doormill_ros.measurements.documents.schemas import RAW_LOADING_TESTS
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.si_units import TWIST, check_values
from doormill_ros.measurements.loading import Loadings
from doormill_ros.measurements.raw.raw_files import read_force_log, read_tracker_file
from doormill_ros.measurements.raw.steady import SteadyWindow, steady_window
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.robot.errors import RobotError
from doormill_ros.robot.kinematics import Kinematics

FILE_NAME = "loading_tests.yaml"


@dataclass(frozen=True, eq=False)
class RawTest:
    """Means of one test, base axes.

    Attributes:
        name: Its name.
        q: Posture, shape (6,) [rad].
        wrench: Load on the robot at the load point, shape (6,) [N, N m].
        load_link: Link that carries the load point.
        load_point: The load point in that link's frame, shape (3,) [m].
        unloaded: Mean position of each reflector without load, tracker origin, shape (m, 3) [m].
        loaded: The same with load.
        thesis: What the thesis' formula of a joint needs beside these, as written.
    """

    name: str
    q: FloatArray
    wrench: FloatArray
    load_link: int
    load_point: FloatArray
    unloaded: FloatArray
    loaded: FloatArray
    thesis: dict[str, Any]


@dataclass(frozen=True, eq=False)
class RawSet:
    """Loading tests made from raw files.

    Attributes:
        robot: The robot that was loaded.
        loadings: One row for each reflector of each test.
        names: Test and reflector number of each row.
        windows: Every steady window that was used, by file name.
        tests: The means of each test.
    """

    robot: Robot
    loadings: Loadings
    names: list[str]
    windows: dict[str, SteadyWindow]
    tests: list[RawTest]


def read_raw_set(folder: str | Path) -> RawSet:
    """Read the folder, take the mean of every steady window and make loadings of them.

    Raises:
        DataFileError: The YAML is missing or no text.
        SetDescriptionError: It lacks something or holds an impossible value.
        RawFileError: A recorded file cannot be read.
        NotSteadyError: A recording holds no steady window.
    """
    reader = _Reader(Path(folder))
    tests = reader.document.get("tests")
    if not isinstance(tests, list) or not tests:
        raise reader.document.fail(("tests",), "is empty, it needs at least one test")
    rows: list[dict[str, Any]] = []
    for index, test in enumerate(tests):
        rows += reader.test(index, test)
    stacked = {key: np.array([row[key] for row in rows]) for key in rows[0] if key != "name"}
    return RawSet(
        reader.robot, Loadings(**stacked), [row["name"] for row in rows], reader.windows, reader.tests
    )


class _Reader:
    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.document = SetDocument(folder / FILE_NAME)
        self.document.check_schema(RAW_LOADING_TESTS)
        try:
            self.robot = load_robot(self.document.text("robot"))
        except RobotError as error:
            raise self.document.fail(("robot",), f"cannot be used: {error.message}") from error
        self.kinematics = Kinematics(self.robot)
        self.rotation = self.document.number("wrench_frame_rotation")
        check_values(self.document, ("wrench_frame_rotation",), self.rotation, TWIST)
        self.load_point = self.document.vector(3, "load_point")
        self.document.check_spelling(("tracker_rotation",))
        tracker = np.zeros(3)
        if "tracker_rotation" in self.document.data:
            tracker = self.document.vector(3, "tracker_rotation")
        self.R_base_tracker = rotation_from_vector(tracker)
        self.noise = {}
        for name in ("displacement", "force", "torque"):
            self.noise[name] = self.document.number("noise", name)
            if self.noise[name] < 0.0 or (name == "displacement" and self.noise[name] == 0.0):
                raise self.document.fail(
                    ("noise", name), f"is {self.noise[name]}, allowed is a positive number"
                )
        self.windows: dict[str, SteadyWindow] = {}
        self.tests: list[RawTest] = []

    def test(self, index: int, test: Any) -> list[dict[str, Any]]:
        where = f"test {index + 1}"
        if not isinstance(test, dict):
            raise self._wrong(where, "is no mapping")
        where = f"test {index + 1} ({test.get('name', 'without name')})"
        q = self._vector(test, "q", JOINTS, where)
        load = self._load(test, q, where)
        reflectors = test.get("reflectors")
        if not isinstance(reflectors, list) or not reflectors:
            raise self._wrong(where, "has no reflectors, it needs at least one")
        rows, positions = [], []
        for number, reflector in enumerate(reflectors, start=1):
            place = f"{where}, reflector {number}"
            if not isinstance(reflector, dict):
                raise self._wrong(place, "is no mapping")
            before = self._window(reflector, "unloaded", read_tracker_file, place)
            after = self._window(reflector, "loaded", read_tracker_file, place)
            positions.append([self.R_base_tracker @ before.mean, self.R_base_tracker @ after.mean])
            spread = np.hypot(before.standard_error, after.standard_error)
            rows.append(
                {
                    "name": f"{test.get('name', index + 1)}/{number}",
                    "q": q,
                    **load,
                    "reflector_link": self._link(reflector, place),
                    "reflector": self._vector(reflector, "position", 3, place),
                    "displacement": self.R_base_tracker @ (after.mean - before.mean),
                    # Standard errors turn with the axes; their squares are the variances along the base axes.
                    "displacement_std": np.sqrt(
                        self.R_base_tracker**2 @ spread**2 + self.noise["displacement"] ** 2
                    ),
                }
            )
        thesis = test.get("thesis", {})
        if not isinstance(thesis, dict):
            raise self._wrong(where, "has a 'thesis' that is no mapping")
        name = str(test.get("name", index + 1))
        at_rest, bent = np.array(positions).swapaxes(0, 1)
        self.tests.append(
            RawTest(name, q, load["wrench"], load["load_link"], load["load_point"], at_rest, bent, thesis)
        )
        return rows

    def _load(self, test: dict[str, Any], q: FloatArray, where: str) -> dict[str, Any]:
        floor = np.array([self.noise["force"]] * 3 + [self.noise["torque"]] * 3)
        if ("load" in test) == ("force" in test):
            raise self._wrong(where, "needs either 'force' (sensor logs) or 'load' (a load past the sensor)")
        if "load" in test:
            load = test["load"]
            if not isinstance(load, dict):
                raise self._wrong(where, "has a 'load' that is no mapping")
            wrench = np.concatenate([self._vector(load, "force", 3, where), np.zeros(3)])
            return {
                "load_link": self._link(load, where),
                "load_point": self._vector(load, "point", 3, where),
                "wrench": wrench,
                "wrench_std": floor,
            }
        force = test["force"]
        if not isinstance(force, dict):
            raise self._wrong(where, "has a 'force' that is no mapping of loaded (and unloaded) to a file")
        loaded = self._window(force, "loaded", read_force_log, where)
        mean, variance = loaded.mean, loaded.standard_error**2
        if "unloaded" in force:
            unloaded = self._window(force, "unloaded", read_force_log, where)
            mean, variance = mean - unloaded.mean, variance + unloaded.standard_error**2
        R_base_sensor = self.kinematics.forward(q)[:3, :3] @ rotation_z(self.rotation)
        # The larger of the three deviations for all axes: they are turned by R_base_sensor.
        spread = np.repeat(np.sqrt(variance.reshape(2, 3).max(axis=1)), 3)
        return {
            "load_link": JOINTS,
            "load_point": self.load_point,
            "wrench": rotate_wrench(R_base_sensor, mean),
            "wrench_std": np.hypot(spread, floor),
        }

    def _window(self, node: dict[str, Any], key: str, read: Any, where: str) -> SteadyWindow:
        name = node.get(key)
        if not isinstance(name, str) or not name:
            raise self._wrong(where, f"names no file under '{key}'")
        if name not in self.windows:
            self.windows[name] = steady_window(read(self.folder / name))
        return self.windows[name]

    def _link(self, node: dict[str, Any], where: str) -> int:
        link = node.get("link")
        if isinstance(link, bool) or not isinstance(link, int) or not 0 <= link <= JOINTS:
            raise self._wrong(where, f"has link {link!r}, allowed is 0 (base) to {JOINTS} (flange)")
        return link

    def _vector(self, node: dict[str, Any], key: str, length: int, where: str) -> FloatArray:
        try:
            vector = np.array(node.get(key), dtype=float)
        except (TypeError, ValueError, OverflowError):
            vector = np.empty(0)
        if vector.shape != (length,) or not np.all(np.isfinite(vector)):
            raise self._wrong(where, f"has {key} {node.get(key)!r}, allowed are {length} finite numbers")
        return vector

    def _wrong(self, where: str, problem: str) -> Exception:
        return self.document.fail(("tests",), f"{where} {problem}")
