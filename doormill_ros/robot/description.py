"""A robot as data: geometry from a URDF, everything else from a YAML that names its sources."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import model_validator

from doormill_ros.arrays import FloatArray
from doormill_ros.config import found, read
from doormill_ros.resources import resource
from doormill_ros.robot.denavit_hartenberg import table_of_chain
from doormill_ros.robot.errors import RobotDescriptionError
from doormill_ros.robot.urdf import JOINTS, Chain, read_chain
from doormill_ros.robot.weights import LinkWeights
from doormill_ros.units import deg_to_rad, rad_to_deg
from doormill_ros.values import Array, Exactly, Positive, Section, contradiction

SCHEMA = "doormill/robot/1"
_FIGURES = ("reach", "payload", "limits", "max_velocity", "stiffness")


@dataclass(frozen=True)
class Provenance:
    """Where a figure comes from, and whether somebody measured it on a robot of this type."""

    source: str
    measured: bool


@dataclass(frozen=True, eq=False)
class Robot:
    """One six-axis robot. Arrays are read-only.

    Attributes:
        name: Folder name in config/robots.
        label: Maker's name.
        urdf: Path of the URDF.
        flange_link: Name of the flange in the URDF.
        dh: Denavit-Hartenberg table, shape (6, 4) [theta_offset rad, d m, a m, alpha rad].
        lower: Lower joint limits, shape (6,) [rad].
        upper: Upper joint limits, shape (6,) [rad].
        max_velocity: Largest joint velocities, shape (6,) [rad/s].
        stiffness: Joint stiffness, shape (6,) [N m/rad].
        stiffness_std: Its standard deviation, shape (6,) [N m/rad]; NaN where nobody stated it, None: nowhere.
        payload: Largest mass at the flange [kg].
        reach: Distance of the stretched wrist centre from axis 1 [m].
        links: What its links weigh; None where nobody stated it.
        provenance: Source of reach, payload, limits, max_velocity and stiffness.
    """

    name: str
    label: str
    urdf: Path
    flange_link: str
    dh: FloatArray
    lower: FloatArray
    upper: FloatArray
    max_velocity: FloatArray
    stiffness: FloatArray
    payload: float
    reach: float
    provenance: dict[str, Provenance]
    stiffness_std: FloatArray | None = None
    links: LinkWeights | None = None

    def unmeasured(self) -> list[str]:
        """Names of the figures that nobody measured."""
        return [name for name, origin in self.provenance.items() if not origin.measured]

    @property
    def caution(self) -> str:
        """What to do before a real robot moves, one sentence; empty where every figure was measured."""
        if not self.unmeasured():
            return ""
        figures = ", ".join(name.replace("_", " ") for name in self.unmeasured())
        return (
            f"{self.label}: nobody measured {figures}, its file says where each is from; that does for a simulated "
            f"cell, before a real robot moves compare them with its manual: the robot.yaml of {self.name}"
        )


Joints = Annotated[FloatArray, Array((JOINTS,))]
PositiveJoints = Annotated[FloatArray, Array((JOINTS,), positive=True)]
_Stated = Positive | None
StatedJoints = tuple[_Stated, _Stated, _Stated, _Stated, _Stated, _Stated]


@dataclass(frozen=True, kw_only=True)
class _Figure(Section):
    source: str
    measured: bool

    @property
    def provenance(self) -> Provenance:
        return Provenance(self.source, self.measured)


@dataclass(frozen=True, kw_only=True)
class _Scalar(_Figure):
    value: Positive


@dataclass(frozen=True, kw_only=True, eq=False)
class _OfJoints(_Figure):
    value: PositiveJoints
    std: StatedJoints | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Limits(_Figure):
    lower: Joints  # degrees
    upper: Joints  # degrees


@dataclass(frozen=True, eq=False)
class _RobotFile(Section):
    schema: Annotated[str, Exactly(SCHEMA)]
    reach: _Scalar
    payload: _Scalar
    limits: _Limits
    max_velocity: _OfJoints  # degrees per second
    stiffness: _OfJoints
    label: str = ""
    urdf: str = "robot.urdf"
    links: LinkWeights | None = None

    @model_validator(mode="before")
    @classmethod
    def _say_where_from(cls, document: Any) -> Any:
        """Every figure has its origin, whatever else is wrong with it."""
        if not isinstance(document, dict) or document.get("schema") != SCHEMA:
            return document
        for name in _FIGURES:
            figure = document.get(name)
            if not isinstance(figure, dict):
                raise contradiction(
                    f"it has no figure '{name}', allowed is one with value, source and measured"
                )
            source, measured = figure.get("source"), figure.get("measured")
            if not source or not isinstance(source, str) or not isinstance(measured, bool):
                raise contradiction(
                    f"'{name}' has source {found(source)} and measured {found(measured)}, "
                    "allowed are where it comes from and true or false"
                )
        return document


def load_robot(name_or_path: str | Path) -> Robot:
    """Read a robot that ships with the project, or a folder or robot.yaml of one's own.

    Args:
        name_or_path: Folder name in config/robots, or the path of such a folder or of its YAML.

    Raises:
        RobotDescriptionError: Nothing there, or the files contradict the form or each other.
    """
    try:
        path = Path(name_or_path)
        if path.is_dir():
            path = path / "robot.yaml"
        elif path.suffix not in (".yaml", ".yml"):
            path = resource(f"config/robots/{name_or_path}/robot.yaml")
        path = path.resolve()
    except (OSError, ValueError) as error:  # not there, or no name that a file can have
        shipped = sorted(folder.name for folder in resource("config/robots").iterdir())
        raise RobotDescriptionError(
            f"no robot '{name_or_path!s:.200}': it is no folder and not one of {', '.join(shipped)}; correct the name",
            robot=str(name_or_path),
        ) from error
    return _load(path)


@functools.cache
def _load(path: Path) -> Robot:
    content = read(path, _RobotFile, RobotDescriptionError)
    urdf = path.parent / content.urdf
    chain = read_chain(urdf)
    lower, upper = deg_to_rad(content.limits.lower), deg_to_rad(content.limits.upper)
    _check_limits(path, lower, upper, chain.lower, chain.upper)
    return Robot(
        name=path.parent.name,
        label=content.label or path.parent.name,
        urdf=urdf,
        flange_link=chain.flange,
        dh=_frozen(_table(urdf, chain)),
        lower=_frozen(lower),
        upper=_frozen(upper),
        max_velocity=_frozen(deg_to_rad(content.max_velocity.value)),
        stiffness=content.stiffness.value,
        payload=content.payload.value,
        reach=content.reach.value,
        provenance={name: getattr(content, name).provenance for name in _FIGURES},
        stiffness_std=None if content.stiffness.std is None else np.array(content.stiffness.std, dtype=float),
        links=content.links,
    )


def _table(urdf: Path, chain: Chain) -> FloatArray:
    try:
        return table_of_chain(chain)
    except RobotDescriptionError as error:
        raise RobotDescriptionError(f"{urdf}: {error.message}") from error


def _check_limits(
    path: Path, lower: FloatArray, upper: FloatArray, urdf_lower: FloatArray, urdf_upper: FloatArray
) -> None:
    for joint in range(JOINTS):
        low, high = lower[joint], upper[joint]
        # A micro-radian for the URDF's finite decimals.
        if not low < high or low < urdf_lower[joint] - 1e-6 or high > urdf_upper[joint] + 1e-6:
            raise RobotDescriptionError(
                f"{path}: joint {joint + 1} has limits {rad_to_deg(low):.3f} to {rad_to_deg(high):.3f} deg, "
                f"allowed is a range within the URDF's {rad_to_deg(urdf_lower[joint]):.3f} to "
                f"{rad_to_deg(urdf_upper[joint]):.3f} deg; narrow it"
            )


def _frozen(array: FloatArray) -> FloatArray:
    array.setflags(write=False)
    return array
