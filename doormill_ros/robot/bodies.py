"""What robot, tool and cell take up: boxes and capsules, each in a frame of its own."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import StrictBool, model_validator

from doormill_ros.arrays import FloatArray
from doormill_ros.config import found, read
from doormill_ros.frames import rotation_rpy, rotations, transform
from doormill_ros.robot.description import Robot
from doormill_ros.robot.errors import RobotDescriptionError
from doormill_ros.robot.urdf import link_names
from doormill_ros.values import Array, Exactly, Name, Positive, Section, Vector3, contradiction

SCHEMA = "doormill/bodies/1"
FILE = "bodies.yaml"
UPRIGHT = 1e-9  #: cosine of a pitch that is 90 degrees
_FORMS = {"box": ("size", "position", "rotation"), "capsule": ("radius", "start", "end")}

Size = Annotated[FloatArray, Array((3,), positive=True)]


@dataclass(frozen=True, eq=False)
class Body(Section):
    """A box or a capsule.

    Attributes:
        name: What a refusal calls it.
        shape: "box" or "capsule".
        size: Edges of a box, shape (3,) [m].
        position: Middle of a box, shape (3,) [m].
        rotation: Roll, pitch and yaw of a box, about the fixed axes x, y, z in this order, shape (3,) [rad].
        radius: Of a capsule [m].
        start: One end of the capsule's axis, shape (3,) [m].
        end: Its other end, shape (3,) [m].
    """

    name: Name
    shape: Name
    size: Size | None = None
    position: Vector3 | None = None
    rotation: Vector3 | None = None
    radius: Positive | None = None
    start: Vector3 | None = None
    end: Vector3 | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_shape(cls, document: Any) -> Any:
        """A box has the keys of a box, a capsule those of a capsule."""
        if not isinstance(document, dict):
            return document
        shape, name = document.get("shape"), document.get("name")
        if not isinstance(shape, str) or shape not in _FORMS:
            raise contradiction(
                f"body {found(name)} has shape {found(shape)}, allowed are {' and '.join(_FORMS)}"
            )
        has = {key for keys in _FORMS.values() for key in keys} & document.keys()
        if has != set(_FORMS[shape]):
            raise contradiction(
                f"{shape} {found(name)} has {', '.join(sorted(has)) or 'no figures'}, allowed are "
                f"{', '.join(_FORMS[shape])}"
            )
        return document

    @functools.cached_property
    def T_frame_body(self) -> FloatArray:
        """Middle of the body with z along a capsule's axis, in the frame it is given in, shape (4, 4)."""
        if self.position is not None and self.rotation is not None:
            return transform(rotation_rpy(self.rotation), self.position)
        start, end = self.ends
        axis = end - start
        length = float(np.linalg.norm(axis))
        turn = np.eye(3)
        if length > 0.0:
            turn = rotations().align_vectors(axis[None] / length, np.array([[0.0, 0.0, 1.0]]))[0].as_matrix()
        return transform(turn, 0.5 * (start + end))

    @property
    def ends(self) -> tuple[FloatArray, FloatArray]:
        """Ends of a capsule's axis, each of shape (3,) [m]."""
        if self.start is None or self.end is None:
            raise TypeError(f"{self.name} is a {self.shape}, only a capsule has ends")
        return self.start, self.end

    @functools.cached_property
    def corners(self) -> FloatArray:
        """Points whose hull, widened by `margin`, is the body, in the frame it is given in, shape (n, 3) [m]."""
        if self.size is None:
            return np.array(self.ends)
        signs = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T
        T = self.T_frame_body
        places: FloatArray = (signs * self.size) @ T[:3, :3].T + T[:3, 3]
        return places

    def mapped(self, T_a_b: FloatArray) -> Self:
        """The body given in frame b, written in frame a; T_a_b of shape (4, 4)."""
        R, p = T_a_b[:3, :3], T_a_b[:3, 3]
        places = {name: getattr(self, name) for name in ("position", "start", "end")}
        changed = {name: R @ at + p for name, at in places.items() if at is not None}
        if self.rotation is not None:
            changed["rotation"] = _roll_pitch_yaw(R @ rotation_rpy(self.rotation))
        return replace(self, **changed)

    @property
    def margin(self) -> float:
        """By how much the body is wider than the hull of its corners [m]."""
        return self.radius or 0.0


def _roll_pitch_yaw(R: FloatArray) -> FloatArray:
    """Angles of R = Rz(yaw) Ry(pitch) Rx(roll), shape (3, 3) -> (3,) [rad]; no yaw for what stands on end."""
    level = float(np.hypot(R[0, 0], R[1, 0]))
    pitch = np.arctan2(-R[2, 0], level)
    if level < UPRIGHT:
        return np.array([np.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkBody(Body):
    """A body that moves with a link of the robot.

    Attributes:
        link: Name of the link in the URDF, in whose frame the body is given.
    """

    link: Name


@dataclass(frozen=True, eq=False)
class _BodiesFile(Section):
    schema: Annotated[str, Exactly(SCHEMA)]
    source: Name
    measured: StrictBool
    bodies: tuple[LinkBody, ...]


def load_bodies(robot: Robot) -> tuple[LinkBody, ...]:
    """What the robot takes up: bodies.yaml beside its URDF.

    Raises:
        RobotDescriptionError: The file is missing or wrong, or names a link that the URDF does not have.
    """
    return _load(robot.urdf)


@functools.cache
def _load(urdf: Path) -> tuple[LinkBody, ...]:
    path = urdf.parent / FILE
    content = read(path, _BodiesFile, RobotDescriptionError, "compare it with that of a shipped robot")
    known = link_names(urdf)
    for body in content.bodies:
        if body.link not in known:
            raise RobotDescriptionError(
                f"{path}: body {body.name} hangs on link {body.link}, allowed are {', '.join(known)}; "
                "name a link of the URDF",
                body=body.name,
                link=body.link,
            )
    return content.bodies
