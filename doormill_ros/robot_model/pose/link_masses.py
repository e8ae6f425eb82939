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
from doormill_ros.resources import resource
from doormill_ros.robot_model.errors import LinkMassError
from doormill_ros.units import GRAVITY
from doormill_ros.values import Array, Exactly, Positive, Section

SCHEMA = "doormill/link-masses/1"
FOLDER = "config/link_masses"
LINKS = 6


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
    links: Annotated[tuple[_Link, ...], Field(min_length=LINKS, max_length=LINKS)]


def read_masses(path: Path) -> tuple[LinkMass, ...]:
    """Masses of the links 1 to 6 of a file of published masses.

    Raises:
        LinkMassError: It cannot be read.
    """
    return tuple(LinkMass(link.mass, link.com) for link in read(path, _MassFile, LinkMassError).links)


@functools.cache
def published_masses(robot: str) -> tuple[LinkMass, ...]:
    """Masses of the links 1 to 6 of a robot as its maker publishes them; empty where no file has them.

    Raises:
        LinkMassError: The robot's file cannot be read.
    """
    files = {path.stem: path for path in resource(FOLDER).glob("*.yaml")}
    return read_masses(files[robot]) if robot in files else ()


def gravity_moment(T_base_frames: FloatArray, links: Sequence[LinkMass]) -> FloatArray:
    """Moment about the origins of frames 0..5 of the weight of the links beyond, in frame axes.

    Args:
        T_base_frames: Frames 0 to 6, shape (n, 7, 4, 4).
        links: Masses of the links 1 to 6; none for no weight.

    Returns:
        Shape (n, 6, 3) [N m].
    """
    n = len(T_base_frames)
    out = np.zeros((n, 6, 3))
    weight_moment, mass = np.zeros((n, 3)), 0.0
    for k in range(5, -1, -1):
        if links:
            link, T = links[k], T_base_frames[:, k + 1]
            weight_moment = weight_moment + link.mass * (T[:, :3, 3] + T[:, :3, :3] @ link.com)
            mass += link.mass
        arm = weight_moment - mass * T_base_frames[:, k, :3, 3]
        torque = GRAVITY * np.stack([-arm[:, 1], arm[:, 0], np.zeros(n)], axis=1)  # arm x (0, 0, -g)
        out[:, k] = np.einsum("nji,nj->ni", T_base_frames[:, k, :3, :3], torque)
    return out
