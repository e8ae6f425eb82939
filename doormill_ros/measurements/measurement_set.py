"""A loading test as a lab hands it over: which robot, which model is questioned, and the measured trials."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.measurements.set_document import SetDocument
from doormill_ros.measurements.trial_table import TrialTable
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotError

SCHEMA = "doormill/measurement-set/1"
JOINT_COLUMNS = tuple(f"q{k}" for k in range(1, 7))
DIRECTION_COLUMNS = tuple(f"a{k}" for k in range(1, 7))
WRENCH_COLUMNS = ("fx", "fy", "fz", "mx", "my", "mz")
DISPLACEMENT_COLUMNS = ("dx", "dy", "dz")
COLUMNS = (
    "trial",
    "t",
    "dt",
    "temperature",
    *JOINT_COLUMNS,
    *DIRECTION_COLUMNS,
    *WRENCH_COLUMNS,
    "reflector",
    *DISPLACEMENT_COLUMNS,
)

#: Commanded angles closer than this belong to one configuration [rad].
SAME_ANGLE = 1e-5


@dataclass(frozen=True)
class Reflector:
    """A target on the robot: its link (0 is the base) and position in the link's DH frame, shape (3,) [m]."""

    link: int
    position: FloatArray


@dataclass(frozen=True)
class Noise:
    """Standard deviation of one recorded value, per axis: displacement [m], force [N], torque [N m]."""

    displacement: float
    force: float
    torque: float


@dataclass(frozen=True, eq=False)
class MeasurementSet:
    """Everything a lab measured in one loading test; arrays are read-only, one trial a row.

    Attributes:
        path: Folder the set was read from.
        robot: Name of the robot.
        dh: Its Denavit-Hartenberg table, shape (6, 4).
        joint_stiffness: Springs of the model in question, shape (6,) [N m / rad].
        noise: Standard deviations of the recorded values.
        wrench_frame_rotation: Rotation about flange z from sensor axes to flange axes [rad].
        load_point: Where the wrench acts, flange frame, shape (3,) [m].
        reflectors: By name.
        trial: Trial numbers, shape (n,).
        time: Time of the loaded measurement, shape (n,) [s].
        dt: Time between unloaded and loaded measurement, shape (n,) [s].
        temperature: Air temperature, shape (n,) [deg C], NaN where not recorded.
        q: Commanded joint angles, shape (n, 6) [rad].
        direction: Last motion of each joint, -1, 0 (unknown) or +1, shape (n, 6).
        wrench: Wrench on the robot at the load point, sensor axes, shape (n, 6) [N, N m].
        reflector: Name of the measured reflector, shape (n,).
        displacement: Loaded minus unloaded position, base frame, shape (n, 3) [m].
    """

    path: Path
    robot: str
    dh: FloatArray
    joint_stiffness: FloatArray
    noise: Noise
    wrench_frame_rotation: float
    load_point: FloatArray
    reflectors: dict[str, Reflector]
    trial: IntArray
    time: FloatArray
    dt: FloatArray
    temperature: FloatArray
    q: FloatArray
    direction: FloatArray
    wrench: FloatArray
    reflector: FloatArray
    displacement: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __len__(self) -> int:
        return len(self.trial)

    @property
    def configuration(self) -> FloatArray:
        """Number of the posture of each trial, shape (n,), counted in order of appearance."""
        seen: dict[tuple[int, ...], int] = {}
        keys = np.round(self.q / SAME_ANGLE).astype(np.int64)
        return np.array([seen.setdefault(tuple(key), len(seen)) for key in keys])

    @property
    def reflector_link(self) -> FloatArray:
        """Link of each trial's reflector, shape (n,)."""
        return np.array([self.reflectors[name].link for name in self.reflector])

    @property
    def reflector_position(self) -> FloatArray:
        """Position of each trial's reflector in its link's frame, shape (n, 3) [m]."""
        return np.array([self.reflectors[name].position for name in self.reflector])


def read_measurement_set(folder: str | Path) -> MeasurementSet:
    """Read a folder with set.yaml and trials.csv.

    Raises:
        DataFileError: A file is missing or is no text.
        SetDescriptionError: set.yaml lacks something or holds an impossible value.
        TrialTableError: trials.csv has a cell or column that cannot be used.
    """
    folder = Path(folder)
    document = SetDocument(folder / "set.yaml")
    if document.get("schema") != SCHEMA:
        raise document.fail(("schema",), f"is {document.get('schema')!r}, allowed is {SCHEMA}")
    robot = str(document.get("robot"))
    try:
        dh = load_robot(robot).dh
    except RobotError as error:
        raise document.fail(("robot",), f"cannot be used: {error.message}") from error
    stiffness = document.vector(6, "model", "joint_stiffness")
    if np.any(stiffness <= 0.0):
        raise document.fail(
            ("model", "joint_stiffness"), f"is {stiffness.tolist()}, allowed are positive numbers"
        )
    noise = Noise(
        *(
            _not_negative(document, document.number("noise", name), "noise", name)
            for name in ("displacement", "force", "torque")
        )
    )
    if noise.displacement == 0.0:
        raise document.fail(("noise", "displacement"), "is 0, allowed is a positive number")
    reflectors = _reflectors(document)
    return MeasurementSet(
        path=folder,
        robot=robot,
        dh=np.array(dh),
        joint_stiffness=stiffness,
        noise=noise,
        wrench_frame_rotation=document.number("wrench_frame_rotation"),
        load_point=document.vector(3, "load_point"),
        reflectors=reflectors,
        **_trials(TrialTable(folder / "trials.csv", COLUMNS), reflectors),
    )


def _not_negative(document: SetDocument, value: float, *keys: str) -> float:
    if value < 0.0:
        raise document.fail(keys, f"is {value}, allowed is no negative number")
    return value


def _reflectors(document: SetDocument) -> dict[str, Reflector]:
    table = document.get("reflectors")
    if not isinstance(table, dict) or not table:
        raise document.fail(("reflectors",), "is empty, it needs at least one named reflector")
    reflectors = {}
    for name in map(str, table):
        keys = ("reflectors", name)
        link = document.get(*keys, "link")
        if isinstance(link, bool) or not isinstance(link, int) or not 0 <= link <= 6:
            raise document.fail((*keys, "link"), f"is {link!r}, allowed is 0 (base) to 6 (flange)")
        reflectors[name] = Reflector(link, document.vector(3, *keys, "position"))
    return reflectors


def _trials(table: TrialTable, reflectors: dict[str, Reflector]) -> dict[str, FloatArray]:
    trial = table.integers("trial")
    for row in range(len(trial)):
        if trial[row] in trial[:row]:
            raise table.fail(row, "trial", f"{trial[row]} stands there twice, trial numbers are unique")
    dt = table.numbers("dt")
    for row in np.flatnonzero(dt < 0.0):
        raise table.fail(int(row), "dt", f"{dt[row]} s is negative")
    direction = table.block(DIRECTION_COLUMNS)
    for row, k in np.argwhere(~np.isin(direction, (-1.0, 0.0, 1.0))):
        raise table.fail(int(row), f"a{k + 1}", f"{direction[row, k]} is not allowed, it is -1, 0 or 1")
    names = table.text("reflector")
    for row, name in enumerate(names):
        if name not in reflectors:
            raise table.fail(
                row, "reflector", f"{name!r} is not described in set.yaml, known: {', '.join(reflectors)}"
            )
    return {
        "trial": trial,
        "time": table.numbers("t"),
        "dt": dt,
        "temperature": table.numbers("temperature", may_be_empty=True),
        "q": table.block(JOINT_COLUMNS),
        "direction": direction,
        "wrench": table.block(WRENCH_COLUMNS),
        "reflector": np.array(names),
        "displacement": table.block(DISPLACEMENT_COLUMNS),
    }
