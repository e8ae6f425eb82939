"""Masses of a robot's links and the moments of their weight."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from doormill_ros.arrays import FloatArray
from doormill_ros.config import read
from doormill_ros.frames import cross
from doormill_ros.resources import resource
from doormill_ros.robot_model.errors import LinkMassError
from doormill_ros.units import GRAVITY
from doormill_ros.values import Array, Exactly, Positive, Section

SCHEMA = "doormill/link-masses/1"
FOLDER = "config/link_masses"


@dataclass(frozen=True, eq=False)
class LinkMass:
    """Mass [kg] and centre of mass [m], shape (3,), in the DH frame of the link."""

    mass: float
    com: FloatArray


@dataclass(frozen=True, eq=False)
class _Link(Section):
    mass: Positive
    com: Annotated[FloatArray, Array((3,))]


@dataclass(frozen=True, eq=False)
class _MassFile(Section):
    schema: Annotated[str, Exactly(SCHEMA)]
    source: str
    links: Annotated[tuple[_Link, ...], Field(min_length=6, max_length=7)]


def read_masses(path: Path) -> tuple[LinkMass, ...]:
    """Masses of the links, base to flange, of a file of published masses.

    Raises:
        LinkMassError: It cannot be read.
    """
    return tuple(LinkMass(link.mass, link.com) for link in read(path, _MassFile, LinkMassError).links)


@functools.cache
def published_masses(robot: str, joints: int = 6) -> tuple[LinkMass, ...]:
    """Masses of the links of a robot as its maker publishes them; empty where no file has them for so many joints.

    Raises:
        LinkMassError: The robot's file cannot be read.
    """
    files = {path.stem: path for path in resource(FOLDER).glob("*.yaml")}
    found = read_masses(files[robot]) if robot in files else ()
    return found if len(found) == joints else ()


def gravity_moment(T_base_frames: FloatArray, links: Sequence[LinkMass], down: FloatArray) -> FloatArray:
    """Moment about the origins of frames 0..J-1 of the weight of the links beyond, in frame axes.

    Args:
        T_base_frames: Frames 0 to J, shape (n, J + 1, 4, 4).
        links: Masses of the links 1 to J; none for no weight.
        down: Unit vector along gravity in base axes, shape (3,).

    Returns:
        Shape (n, J, 3) [N m].
    """
    n, joints = len(T_base_frames), T_base_frames.shape[1] - 1
    out = np.zeros((n, joints, 3))
    weight_moment, mass = np.zeros((n, 3)), 0.0
    for k in range(joints - 1, -1, -1):
        if links:
            link, T = links[k], T_base_frames[:, k + 1]
            weight_moment = weight_moment + link.mass * (T[:, :3, 3] + T[:, :3, :3] @ link.com)
            mass += link.mass
        arm = weight_moment - mass * T_base_frames[:, k, :3, 3]
        torque = GRAVITY * cross(arm, down)
        out[:, k] = np.einsum("nji,nj->ni", T_base_frames[:, k, :3, :3], torque)
    return out
