"""Where the links of a robot are, read from its URDF by code of the judge's own."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.truth.chain import shift, turn

BASE, FLANGE = "base_link", "flange"


@dataclass(frozen=True, eq=False)
class _Joint:
    child: str
    origin: FloatArray  # (4, 4) in the parent link
    axis: FloatArray | None  # (3,); None for a fixed joint


@dataclass(frozen=True, eq=False)
class Links:
    """A serial arm from base_link to its flange.

    Attributes:
        joints: In the order from the base.
    """

    joints: tuple[_Joint, ...]

    @classmethod
    def read(cls, urdf: Path) -> Links:
        """Take names, lengths and axes from a URDF.

        Raises:
            ValueError: The file does not lead from base_link to flange.
        """
        by_parent = {}
        for joint in ET.parse(urdf).getroot().findall("joint"):
            parent, child, origin = (joint.find(tag) for tag in ("parent", "child", "origin"))
            if parent is None or child is None or origin is None:
                raise ValueError(f"{urdf}: joint {joint.get('name')} lacks parent, child or origin")
            axis = joint.find("axis")
            turns = joint.get("type") == "revolute" and axis is not None
            by_parent[parent.attrib["link"]] = _Joint(
                child.attrib["link"],
                pose(_numbers(origin.get("xyz", "0 0 0")), _numbers(origin.get("rpy", "0 0 0"))),
                _numbers(axis.attrib["xyz"]) if turns and axis is not None else None,
            )
        joints, link = [], BASE
        while link in by_parent and link != FLANGE:
            joints.append(by_parent[link])
            link = joints[-1].child
        if link != FLANGE:
            raise ValueError(f"{urdf}: the joints lead from {BASE} to {link}, allowed is to {FLANGE}")
        return cls(tuple(joints))

    @property
    def names(self) -> tuple[str, ...]:
        """Links from the base to the flange."""
        return (BASE, *(joint.child for joint in self.joints))

    def frames(self, q: FloatArray) -> dict[str, FloatArray]:
        """Pose of every link in base_link, shape (n, 4, 4) each, at joint angles q (n, 6) [rad]."""
        at = np.broadcast_to(np.eye(4), (len(q), 4, 4))
        found, turned = {BASE: at}, 0
        for joint in self.joints:
            at = at @ joint.origin
            if joint.axis is not None:
                at = at @ shift(turn(q[:, turned, None] * joint.axis), np.zeros((len(q), 3)))
                turned += 1
            found[joint.child] = at
        return found

    def reach(self, link: str, extent: float) -> FloatArray:
        """How far a point within `extent` [m] of a link's origin is from each joint's axis at most, shape (6,) [m].

        Zero for the joints that do not move the link.
        """
        lengths, turns = [], []
        for joint in self.joints[: self.names.index(link)]:
            lengths.append(float(np.linalg.norm(joint.origin[:3, 3])))
            turns.append(joint.axis is not None)
        far = [extent + sum(lengths[k + 1 :]) for k, turned in enumerate(turns) if turned]
        return np.pad(far, (0, 6 - len(far)))


def pose(position: FloatArray, rpy: FloatArray) -> FloatArray:
    """Matrix (4, 4) of a position [m] and roll, pitch, yaw about fixed x, y, z [rad], as in URDF."""
    rolls = [turn((angle * axis)[None])[0] for angle, axis in zip(rpy, np.eye(3), strict=True)]
    matrix: FloatArray = shift(
        (rolls[2] @ rolls[1] @ rolls[0])[None], np.asarray(position, dtype=float)[None]
    )[0]
    return matrix


def _numbers(text: str) -> FloatArray:
    return np.array([float(word) for word in text.split()])
