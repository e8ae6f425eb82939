"""The thesis' six loading tests as data, and as loadings that the full model can predict."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.config import read_document
from doormill_ros.frames import rotate_wrench
from doormill_ros.measurements.errors import LoadingTestError
from doormill_ros.measurements.loading import Loadings
from doormill_ros.measurements.raw.force_sensor import sensor_to_flange
from doormill_ros.resources import resource
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.units import GRAVITY, UM, deg_to_rad

SCHEMA = "doormill/thesis-loading-tests/1"


@dataclass(frozen=True, eq=False)
class ThesisTest:
    """One loading test.

    Attributes:
        joint: Number of the joint it was made for.
        q: Posture, shape (6,) [rad].
        wrench_flange: Sensor readings turned into flange axes, shape (6,) [N, N m]; NaN past the sensor.
        force_base: Load, base axes, shape (3,) [N].
        moment_base: Couple of the load beside its lever, base axes, shape (3,) [N m].
        load_link: Link that carries the load.
        load_point: Where it acts, frame of that link, shape (3,) [m].
        load_arm: L_1 as printed [m], NaN where the thesis reads a torque instead.
        reflector_link: Link that carries the reflector.
        reflector: Its position in that link's frame, shape (3,) [m].
        measured: Displacement of table 4.2 [m].
        simulated: Simulated displacement of table 4.2 [m].
        simulated_components: As the appendix prints them, shape (3,) [m]; NaN for joint 4.
        extra: Further printed lengths and angles by name.
    """

    joint: int
    q: FloatArray
    wrench_flange: FloatArray
    force_base: FloatArray
    moment_base: FloatArray
    load_link: int
    load_point: FloatArray
    load_arm: float
    reflector_link: int
    reflector: FloatArray
    measured: float
    simulated: float
    simulated_components: FloatArray
    extra: dict[str, float]


@dataclass(frozen=True, eq=False)
class ThesisData:
    """All six tests and the tables beside them.

    Attributes:
        robot: The robot of the thesis.
        tests: Joint 1 to 6.
        ratios: Table 4.1, shape (6,).
        table_4_2: Its printed rows by name, shape (6,) each, micrometres and percent.
        table_4_3: Normalized stiffness of joint 1, `preloaded` and `not_preloaded`.
        load_mass: Weight used in every test [kg].
        tool_z: Load point in front of the flange [m].
    """

    robot: Robot
    tests: tuple[ThesisTest, ...]
    ratios: FloatArray
    table_4_2: dict[str, FloatArray]
    table_4_3: dict[str, FloatArray]
    load_mass: float
    tool_z: float

    def test(self, joint: int) -> ThesisTest:
        """The test made for a joint, 1..6."""
        return self.tests[joint - 1]

    def loadings(self, displacement_std: float) -> Loadings:
        """The tests as loadings without displacement vectors, which the thesis does not print (zeros)."""
        tests = self.tests
        return Loadings(
            q=np.array([t.q for t in tests]),
            wrench=np.array([np.concatenate([t.force_base, t.moment_base]) for t in tests]),
            load_link=np.array([t.load_link for t in tests]),
            load_point=np.array([t.load_point for t in tests]),
            reflector_link=np.array([t.reflector_link for t in tests]),
            reflector=np.array([t.reflector for t in tests]),
            displacement=np.zeros((len(tests), 3)),
            displacement_std=np.full((len(tests), 3), displacement_std),
            wrench_std=np.zeros((len(tests), 6)),
        )


def load_thesis_data(path: Path | None = None, force_joint4: float | None = None) -> ThesisData:
    """Read the shipped tests.

    Args:
        path: Another file of the same form.
        force_joint4: Load of the joint 4 test [N], which the thesis does not print; its weight when None.

    Raises:
        LoadingTestError: The file does not have the form.
    """
    path = resource("config/loading_tests/thesis.yaml") if path is None else Path(path)
    document = read_document(path, LoadingTestError)
    try:
        if document["schema"] != SCHEMA:
            raise LoadingTestError(f"{path} has schema {document['schema']!r}, allowed is {SCHEMA}")
        return _data(document, force_joint4)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise LoadingTestError(f"{path} does not hold loading tests as {SCHEMA}: {error!r}") from error


def _data(document: dict[str, Any], force_joint4: float | None) -> ThesisData:
    robot = load_robot(document["robot"])
    kinematics = Kinematics(robot)
    angle = float(np.arctan2(*document["sensor_mounting"]))
    table = {name: np.array(row, dtype=float) for name, row in document["table_4_2"].items()}
    # The thesis does not say which gravity it used: 197 N / 20.120 kg is 9.791 m/s^2.
    weight = document["load_mass"] * GRAVITY if force_joint4 is None else force_joint4
    tests = []
    for index, entry in enumerate(document["tests"]):
        if entry["joint"] != index + 1:
            raise ValueError(f"test {index + 1} is for joint {entry['joint']}")
        q = deg_to_rad(np.array(entry["q_deg"], dtype=float))
        load_link, load_point = JOINTS, np.array([0.0, 0.0, document["tool_z"]])
        wrench_flange, moment = np.full(6, np.nan), np.zeros(3)
        R_base_flange = kinematics.forward(q)[:3, :3]
        if "load" in entry:
            load_link, load_point = entry["load"]["link"], np.array(entry["load"]["point"], dtype=float)
            force = np.array(entry["load"]["force_base"], dtype=float)
        elif "wrench_sensor" in entry:
            wrench_flange = sensor_to_flange(np.array(entry["wrench_sensor"], dtype=float), angle)
            # Mx and My are the lever of the force from the sensor, which the load point already holds; only
            # the couple about the spindle axis is a load of its own.
            at_tool = np.concatenate([wrench_flange[:3], [0.0, 0.0, wrench_flange[5]]])
            force, moment = np.split(rotate_wrench(R_base_flange, at_tool), 2)
        else:
            force = R_base_flange @ np.array([weight if f is None else f for f in entry["force_flange"]])
        tests.append(
            ThesisTest(
                joint=index + 1,
                q=q,
                wrench_flange=wrench_flange,
                force_base=force,
                moment_base=moment,
                load_link=load_link,
                load_point=load_point,
                load_arm=float(entry.get("load_arm", np.nan)),
                reflector_link=entry["reflector"]["link"],
                reflector=np.array(entry["reflector"]["position"], dtype=float),
                measured=table["measured_um"][index] * UM,
                simulated=table["simulated_um"][index] * UM,
                simulated_components=np.array(entry.get("simulated_components", [np.nan] * 3), dtype=float),
                extra={k: v for k, v in entry.items() if k in _EXTRA},
            )
        )
    return ThesisData(
        robot=robot,
        tests=tuple(tests),
        ratios=np.array(document["table_4_1"]["value"], dtype=float),
        table_4_2=table,
        table_4_3={name: np.array(row, dtype=float) for name, row in document["table_4_3"].items()},
        load_mass=float(document["load_mass"]),
        tool_z=float(document["tool_z"]),
    )


_EXTRA = ("radius", "radius_R4", "lever_L2", "simulated_rotation")
