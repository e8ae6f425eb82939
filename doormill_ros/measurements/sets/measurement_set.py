"""A loading test as a lab hands it over: which robot, which model is questioned, and the measured trials."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.frames import WRENCH_COMPONENTS
from doormill_ros.measurements.documents.schemas import MEASUREMENT_SET
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.si_units import (
    DISPLACEMENT,
    JOINT_ANGLE,
    LENGTH,
    TWIST,
    check_cells,
    check_values,
)
from doormill_ros.measurements.documents.trial_table import TrialTable
from doormill_ros.measurements.trials import Noise, Reflector, Trials
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotError

JOINT_COLUMNS = tuple(f"q{k}" for k in range(1, 7))
DIRECTION_COLUMNS = tuple(f"a{k}" for k in range(1, 7))
DISPLACEMENT_COLUMNS = ("dx", "dy", "dz")
COLUMNS = (
    "trial",
    "t",
    "dt",
    "temperature",
    *JOINT_COLUMNS,
    *DIRECTION_COLUMNS,
    *WRENCH_COMPONENTS,
    "reflector",
    *DISPLACEMENT_COLUMNS,
)


@dataclass(frozen=True, eq=False)
class MeasurementSet(Trials):
    """Everything a lab measured in one loading test.

    Attributes:
        path: Folder the set was read from.
    """

    path: Path


def read_measurement_set(folder: str | Path) -> MeasurementSet:
    """Read a folder with set.yaml and trials.csv.

    Raises:
        DataFileError: A file is missing or is no text.
        SetDescriptionError: set.yaml lacks something or holds an impossible value.
        TrialTableError: trials.csv has a cell or column that cannot be used.
    """
    folder = Path(folder)
    document = SetDocument(folder / "set.yaml")
    document.check_schema(MEASUREMENT_SET)
    robot = document.text("robot")
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
    load_point, rotation = document.vector(3, "load_point"), document.number("wrench_frame_rotation")
    check_values(document, ("load_point",), load_point, LENGTH)
    check_values(document, ("wrench_frame_rotation",), rotation, TWIST)
    return MeasurementSet(
        path=folder,
        robot=robot,
        dh=np.array(dh),
        joint_stiffness=stiffness,
        noise=noise,
        wrench_frame_rotation=rotation,
        load_point=load_point,
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
        position = document.vector(3, *keys, "position")
        check_values(document, (*keys, "position"), position, LENGTH)
        reflectors[name] = Reflector(link, position)
    return reflectors


def _trials(table: TrialTable, reflectors: dict[str, Reflector]) -> dict[str, Any]:
    trial = table.integers("trial")
    for row in range(len(trial)):
        if trial[row] in trial[:row]:
            raise table.fail(row, "trial", f"{trial[row]} stands there twice, trial numbers are unique")
    dt = table.numbers("dt")
    for late in np.flatnonzero(dt < 0.0):
        raise table.fail(int(late), "dt", f"{dt[late]} s is negative")
    direction = table.block(DIRECTION_COLUMNS)
    for row, k in np.argwhere(~np.isin(direction, (-1.0, 0.0, 1.0))):
        raise table.fail(int(row), f"a{k + 1}", f"{direction[row, k]} is not allowed, it is -1, 0 or 1")
    names = table.text("reflector")
    for row, name in enumerate(names):
        if name not in reflectors:
            raise table.fail(
                row, "reflector", f"{name!r} is not described in set.yaml, known: {', '.join(reflectors)}"
            )
    q, displacement = table.block(JOINT_COLUMNS), table.block(DISPLACEMENT_COLUMNS)
    check_cells(table, JOINT_COLUMNS, q, JOINT_ANGLE)
    check_cells(table, DISPLACEMENT_COLUMNS, displacement, DISPLACEMENT, middle=True)
    return {
        "trial": trial,
        "time": table.numbers("t"),
        "dt": dt,
        "temperature": table.numbers("temperature", may_be_empty=True),
        "q": q,
        "direction": direction,
        "wrench": table.block(WRENCH_COMPONENTS),
        "reflector": np.array(names),
        "displacement": displacement,
    }
