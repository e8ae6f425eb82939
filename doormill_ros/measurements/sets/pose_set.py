"""A series of poses as a lab hands it over: the model in question and what the tracker saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.documents.schemas import POSE_SET
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.si_units import (
    DISTANCE,
    JOINT_ANGLE,
    LENGTH,
    TWIST,
    check_cells,
    check_values,
)
from doormill_ros.measurements.documents.trial_table import TrialTable
from doormill_ros.measurements.errors import PoseTableError
from doormill_ros.robot_model.pose.link_masses import LinkMass, published_masses
from doormill_ros.robot_model.pose.stance import UPRIGHT, Stance
from doormill_ros.robot_model.pose.view import SetView

#: Numbers of joints that a robot may have.
JOINTS = (6, 7)
POSITION_COLUMNS = ("x", "y", "z")
QUATERNION_COLUMNS = ("qw", "qx", "qy", "qz")
COLUMNS = ("row", "t", "temperature", *POSITION_COLUMNS, "placement")
#: What a set says whose placement is that of another.
SAME = "same as "

#: Of what set.yaml may state the noise.
NOISE = ("position", "rotation")
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
        dh: Nominal table, shape (J, 4) of 6 or 7 joints: theta_offset, d, a, alpha.
        links: Masses of the links, empty where not known.
        noise: Standard deviation per axis, position [m] and rotation [rad].
        assumed: What of the noise set.yaml does not state, so that `DEFAULT_NOISE` is assumed: position, rotation.
        same_as: Name of the set whose placement this one has; empty where it has its own.
        row: Row numbers in the order of recording, shape (n,).
        time: Since the start of the set, shape (n,) [s], NaN where not recorded.
        temperature: Shape (n,) [deg C], NaN where not recorded.
        q: Recorded joint angles, shape (n, J) [rad].
        position: Target in the tracker frame, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3), or None where positions alone were measured.
        placement: Rows that may place the set when it is only checked, shape (n,) bool.
        stance: How the robot stood to gravity and what it carried, which set.yaml does not tell: upright, nothing.
    """

    path: Path
    robot: str
    source: str
    dh: FloatArray
    links: tuple[LinkMass, ...]
    noise: tuple[float, float]
    assumed: tuple[str, ...]
    same_as: str
    row: IntArray
    time: FloatArray
    temperature: FloatArray
    q: FloatArray
    position: FloatArray
    rotation: FloatArray | None
    placement: BoolArray
    stance: Stance = UPRIGHT

    def __len__(self) -> int:
        return len(self.row)

    @property
    def joints(self) -> int:
        """Number of joints J."""
        return len(self.dh)

    @property
    def oriented(self) -> bool:
        """Whether the target's orientation was measured."""
        return self.rotation is not None

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.path.resolve().name

    @cached_property
    def view(self) -> SetView:
        """The postures, with published masses where the set states none."""
        links = self.links or published_masses(self.robot, self.joints)
        return SetView(
            self.name,
            self.dh,
            links,
            self.q,
            self.row,
            time=self.time,
            temperature=self.temperature,
            stance=self.stance,
        )


def read_pose_set(folder: Path) -> PoseSet:
    """Read set.yaml and poses.csv.

    Raises:
        DataSetError: A file is missing, or a value cannot be used; the message names file, line and column.
    """
    document = SetDocument(folder / "set.yaml")
    document.check_schema(POSE_SET)
    document.check_spelling(("source", "noise", "placement"))
    document.check_spelling(("dh", "links"), "model")
    same_as = _same_as(document)
    dh = _dh(document)
    joints = tuple(f"q{k}" for k in range(1, len(dh) + 1))
    table = TrialTable(folder / "poses.csv", (*COLUMNS, *joints))
    beyond = f"q{len(dh) + 1}"
    if beyond in table.columns:
        raise _fail(table, 0, beyond, f"model.dh has {len(dh)} rows, one for each of {', '.join(joints)}")
    rotation = _rotation(table)
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
        "q": table.block(joints),
        "position": table.block(POSITION_COLUMNS),
        "placement": flag == 1,
    }
    check_cells(table, joints, arrays["q"], JOINT_ANGLE)
    check_cells(table, POSITION_COLUMNS, arrays["position"], DISTANCE)
    for array in arrays.values():
        array.setflags(write=False)
    if rotation is not None:
        rotation.setflags(write=False)
    return PoseSet(
        path=folder,
        robot=document.text("robot"),
        source=document.text("source") if "source" in document.data else "",
        dh=dh,
        links=_links(document, len(dh)),
        noise=_noise(document),
        assumed=tuple(name for name in NOISE if name not in (document.data.get("noise") or ())),
        same_as=same_as,
        rotation=rotation,
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


def _same_as(document: SetDocument) -> str:
    placement = document.data.get("placement", "fitted")
    if placement == "fitted":
        return ""
    name = placement.removeprefix(SAME).strip() if isinstance(placement, str) else ""
    if not name or name == placement:
        raise document.fail(
            ("placement",),
            f"is {placement!r}, allowed are fitted and '{SAME}NAME', NAME a set given together",
        )
    return name


def _rotation(table: TrialTable) -> FloatArray | None:
    """R_tracker_target, shape (n, 3, 3); None where the table has no column of orientation, or nothing in any."""
    given = [name for name in QUATERNION_COLUMNS if name in table.columns and any(table.text(name))]
    if not given:
        return None
    table.require(QUATERNION_COLUMNS)
    for name in QUATERNION_COLUMNS:
        if "" in table.text(name):
            raise _fail(
                table,
                table.text(name).index(""),
                name,
                "is empty, allowed is a number in every row, or in none where positions alone were measured: "
                "fill it in, leave the pose out, or leave out qw, qx, qy and qz",
            )
    quaternion = table.block(QUATERNION_COLUMNS)
    norm = np.linalg.norm(quaternion, axis=1)
    for index in np.flatnonzero(np.abs(norm - 1.0) > NORM_TOLERANCE):
        raise _fail(table, int(index), "qw", f"the quaternion has norm {norm[index]:.4f}, allowed is 1")
    result: FloatArray = Rotation.from_quat(quaternion[:, [1, 2, 3, 0]]).as_matrix()
    return result


def placement_owners(sets: Sequence[PoseSet]) -> tuple[int, ...]:
    """For every set the index of the first one that has the same placement; its own where it is that one.

    Raises:
        SetDescriptionError: A set names another that is not given, that is itself, or of which there are several.
    """
    owner = list(range(len(sets)))
    for index, data in enumerate(sets):
        if not data.same_as:
            continue
        found = [i for i, other in enumerate(sets) if other.name == data.same_as and i != index]
        if len(found) != 1:
            given = ", ".join(dict.fromkeys(other.name for i, other in enumerate(sets) if i != index))
            raise SetDocument(data.path / "set.yaml").fail(
                ("placement",),
                f"is the same as {data.same_as!r}, of which {len(found)} are given together with it, allowed is 1; "
                f"the others given are {given or 'none'}: give that set too, or write fitted",
            )
        one, two = sorted((owner[index], owner[found[0]]))
        owner = [one if at == two else at for at in owner]
    return tuple(owner)


def _dh(document: SetDocument) -> FloatArray:
    rows = document.get("model", "dh")
    try:
        dh = np.array(rows, dtype=float)
    except (TypeError, ValueError, OverflowError):
        dh = np.zeros(0)
    if dh.shape not in [(count, 4) for count in JOINTS] or not np.all(np.isfinite(dh)):
        raise document.fail(
            ("model", "dh"), "is no table of 6 or 7 rows [theta_offset, d, a, alpha] of finite numbers"
        )
    for columns, what in (([0, 3], TWIST), ([1, 2], LENGTH)):
        check_values(document, ("model", "dh"), dh[:, columns], what)
    dh.setflags(write=False)
    return dh


def _links(document: SetDocument, joints: int) -> tuple[LinkMass, ...]:
    """Masses of all links; of one that the set does not know, the published one; empty where it knows none."""
    links: Any = document.get("model").get("links")
    if links is None or (isinstance(links, list) and all(link is None for link in links)):
        return ()
    if isinstance(links, list) and len(links) == joints and None in links:
        published = published_masses(document.text("robot"), joints)
        if not published:
            raise document.fail(
                ("model", "links"),
                f"knows nothing of link {links.index(None) + 1}, and nobody published the masses of "
                f"{document.text('robot')}: state all {joints}, or leave out links",
            )
    else:
        published = ()
    try:
        found = tuple(
            published[k]
            if link is None
            else LinkMass(float(link["mass"]), np.array(link["com"], dtype=float))
            for k, link in enumerate(links)
        )
        good = len(found) == joints and all(
            link.mass >= 0.0
            and np.isfinite(link.mass)
            and link.com.shape == (3,)
            and np.all(np.isfinite(link.com))
            for link in found
        )
    except (TypeError, ValueError, KeyError, IndexError, OverflowError):
        good = False
    if not good:
        raise document.fail(
            ("model", "links"),
            f"needs {joints} entries {{mass: kg, com: [x, y, z] m}}, null for a link that is not known; leave it out "
            "where none is",
        )
    check_values(document, ("model", "links"), [link.com for link in found], LENGTH)
    return found


def _noise(document: SetDocument) -> tuple[float, float]:
    if document.data.get("noise") is None:
        return DEFAULT_NOISE
    noise = document.get("noise")
    if not isinstance(noise, dict):
        raise document.fail(("noise",), "needs position and rotation")
    document.check_spelling(NOISE, "noise")
    return tuple(  # type: ignore[return-value]
        document.number("noise", name, positive=True) if name in noise else default
        for name, default in zip(NOISE, DEFAULT_NOISE, strict=True)
    )
