"""A series of poses as a lab hands it over: the model in question and what the tracker saw."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.errors import PoseTableError
from doormill_ros.measurements.set_document import SetDocument
from doormill_ros.measurements.trial_table import TrialTable
from doormill_ros.robot_model.pose.link_masses import LinkMass, published_masses
from doormill_ros.robot_model.pose.view import SetView

SCHEMA = "doormill/pose-set/1"
JOINT_COLUMNS = tuple(f"q{k}" for k in range(1, 7))
POSITION_COLUMNS = ("x", "y", "z")
QUATERNION_COLUMNS = ("qw", "qx", "qy", "qz")
COLUMNS = ("row", "t", "temperature", *JOINT_COLUMNS, *POSITION_COLUMNS, *QUATERNION_COLUMNS, "placement")

#: Noise that is assumed where a set does not state it [m], [rad].
DEFAULT_NOISE = (1.5e-5, 6.0e-5)
#: Largest deviation of a quaternion's norm from 1.
NORM_TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class PoseSet:
    """One series of poses; arrays are read-only, one pose a row.

    Attributes:
        path: Folder the set was read from.
        robot: Name of the robot.
        source: Where the data come from.
        dh: Nominal table, shape (6, 4): theta_offset, d, a, alpha.
        links: Masses of the links, empty where not known.
        noise: Standard deviation per axis, position [m] and rotation [rad].
        row: Row numbers in the order of recording, shape (n,).
        time: Since the start of the set, shape (n,) [s], NaN where not recorded.
        temperature: Shape (n,) [deg C], NaN where not recorded.
        q: Recorded joint angles, shape (n, 6) [rad].
        position: Target in the tracker frame, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3).
        placement: Rows that may place the set when it is only checked, shape (n,) bool.
    """

    path: Path
    robot: str
    source: str
    dh: FloatArray
    links: tuple[LinkMass, ...]
    noise: tuple[float, float]
    row: IntArray
    time: FloatArray
    temperature: FloatArray
    q: FloatArray
    position: FloatArray
    rotation: FloatArray
    placement: BoolArray

    def __len__(self) -> int:
        return len(self.row)

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.path.resolve().name

    @cached_property
    def view(self) -> SetView:
        """The postures, with published masses where the set states none."""
        links = self.links or published_masses(self.robot)
        return SetView(self.name, self.dh, links, self.q, self.row)


def read_pose_set(folder: Path) -> PoseSet:
    """Read set.yaml and poses.csv.

    Raises:
        DataSetError: A file is missing, or a value cannot be used; the message names file, line and column.
    """
    document = SetDocument(folder / "set.yaml")
    if document.get("schema") != SCHEMA:
        raise document.fail(("schema",), f"is {document.get('schema')!r}, allowed is {SCHEMA}")
    placement = document.data.get("placement", "fitted")
    if placement != "fitted":
        raise document.fail(("placement",), f"is {placement!r}, allowed is fitted")
    table = TrialTable(folder / "poses.csv", COLUMNS)
    quaternion = table.block(QUATERNION_COLUMNS)
    norm = np.linalg.norm(quaternion, axis=1)
    for index in np.flatnonzero(np.abs(norm - 1.0) > NORM_TOLERANCE):
        raise _fail(table, int(index), "qw", f"the quaternion has norm {norm[index]:.4f}, allowed is 1")
    row = table.integers("row")
    for index in np.flatnonzero(np.diff(row) <= 0):
        raise _fail(
            table, int(index) + 1, "row", f"{row[index + 1]} follows {row[index]}, rows have to ascend"
        )
    flag = table.integers("placement")
    for index in np.flatnonzero((flag != 0) & (flag != 1)):
        raise _fail(table, int(index), "placement", f"is {flag[index]}, allowed are 0 and 1")
    arrays: dict[str, Any] = {
        "row": row,
        "time": table.numbers("t", may_be_empty=True),
        "temperature": table.numbers("temperature", may_be_empty=True),
        "q": table.block(JOINT_COLUMNS),
        "position": table.block(POSITION_COLUMNS),
        "rotation": Rotation.from_quat(quaternion[:, [1, 2, 3, 0]]).as_matrix(),
        "placement": flag == 1,
    }
    for array in arrays.values():
        array.setflags(write=False)
    return PoseSet(
        path=folder,
        robot=str(document.get("robot")),
        source=str(document.data.get("source", "")),
        dh=_dh(document),
        links=_links(document),
        noise=_noise(document),
        **arrays,
    )


def _fail(table: TrialTable, index: int, column: str, problem: str) -> DataSetError:
    line = table.lines[index]
    return PoseTableError(
        f"{table.path}: line {line}, column {column}: {problem}",
        path=str(table.path),
        line=line,
        column=column,
    )


def _dh(document: SetDocument) -> FloatArray:
    rows = document.get("model", "dh")
    try:
        dh = np.array(rows, dtype=float)
    except (TypeError, ValueError):
        dh = np.zeros(0)
    if dh.shape != (6, 4) or not np.all(np.isfinite(dh)):
        raise document.fail(
            ("model", "dh"), "is no table of 6 rows [theta_offset, d, a, alpha] of finite numbers"
        )
    dh.setflags(write=False)
    return dh


def _links(document: SetDocument) -> tuple[LinkMass, ...]:
    links: Any = document.get("model").get("links")
    if links is None:
        return ()
    try:
        found = tuple(LinkMass(float(link["mass"]), np.array(link["com"], dtype=float)) for link in links)
        good = len(found) == 6 and all(
            link.mass >= 0.0
            and np.isfinite(link.mass)
            and link.com.shape == (3,)
            and np.all(np.isfinite(link.com))
            for link in found
        )
    except (TypeError, ValueError, KeyError):
        good = False
    if not good:
        raise document.fail(("model", "links"), "needs 6 entries {mass: kg, com: [x, y, z] m}")
    return found


def _noise(document: SetDocument) -> tuple[float, float]:
    if document.data.get("noise") is None:
        return DEFAULT_NOISE
    noise = document.get("noise")
    if not isinstance(noise, dict):
        raise document.fail(("noise",), "needs position and rotation")
    return tuple(  # type: ignore[return-value]
        document.number("noise", name, positive=True) if name in noise else default
        for name, default in zip(("position", "rotation"), DEFAULT_NOISE, strict=True)
    )
