"""Read the one serial chain of six revolute joints out of a URDF."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import rotation_from_vector, rotation_rpy, transform
from doormill_ros.robot.errors import RobotDescriptionError

JOINTS = 6


@dataclass(frozen=True, eq=False)
class Chain:
    """A serial chain in its zero position.

    Attributes:
        base: Name of the root link.
        flange: Name of the last link.
        axes: Unit vectors of the joint axes, base axes, shape (6, 3).
        points: One point on each axis, base frame, shape (6, 3) [m].
        T_base_flange: Flange in the base frame, shape (4, 4).
        lower: Lower joint limits, shape (6,) [rad].
        upper: Upper joint limits, shape (6,) [rad].
    """

    base: str
    flange: str
    axes: FloatArray
    points: FloatArray
    T_base_flange: FloatArray
    lower: FloatArray
    upper: FloatArray


def read_chain(path: Path) -> Chain:
    """Walk the URDF from its root link to its only leaf behind six revolute joints.

    Links that end beside the chain (a balancing cylinder, a second base frame) are passed by:
    among all leaves the one behind six moving joints counts; of several the deepest.

    Raises:
        RobotDescriptionError: Not XML, several roots, a loop, or not exactly six moving joints.
    """
    base, flange, steps = _chain_joints(path)
    return _zero_position(path, base, flange, steps)


@dataclass(frozen=True, eq=False)
class LinkPose:
    """A link of the chain: its frame in that of its parent link, T_parent_child, shape (4, 4)."""

    parent: str
    child: str
    T_parent_child: FloatArray


def link_poses(path: Path, q: FloatArray) -> list[LinkPose]:
    """The chain's links from the base to the flange, under the names that the URDF gives them.

    Args:
        path: URDF.
        q: Angles of the moving joints, shape (6,) [rad].

    Raises:
        RobotDescriptionError: See `read_chain`.
    """
    _, _, steps = _chain_joints(path)
    poses, angles = [], iter(np.asarray(q, dtype=float))
    for joint in steps:
        T_parent_child = _origin(path, joint)
        if joint.get("type") != "fixed":
            turn = rotation_from_vector(next(angles) * _axis(path, joint))
            T_parent_child = T_parent_child @ transform(turn)
        poses.append(LinkPose(_link(path, joint, "parent"), _link(path, joint, "child"), T_parent_child))
    return poses


def joint_names(path: Path) -> list[str]:
    """Names of the six moving joints, from the base on."""
    return [joint.get("name", "") for joint in _chain_joints(path)[2] if joint.get("type") != "fixed"]


def link_names(path: Path) -> list[str]:
    """Names of the links of the chain, from the base to the flange."""
    base, _, steps = _chain_joints(path)
    return [base, *(_link(path, joint, "child") for joint in steps)]


def _chain_joints(path: Path) -> tuple[str, str, list[ElementTree.Element]]:
    """Root link, last link, and the joints between them."""
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise RobotDescriptionError(f"{path} is not a readable URDF: {error}", path=str(path)) from error
    parent_joint: dict[str, ElementTree.Element] = {}
    for joint in root.findall("joint"):
        child = _link(path, joint, "child")
        if child in parent_joint:
            raise RobotDescriptionError(
                f"{path}: link {child} hangs on two joints, allowed is one; remove the other"
            )
        parent_joint[child] = joint
    links = [link.get("name", "") for link in root.findall("link")]
    roots = [link for link in links if link not in parent_joint]
    if len(roots) != 1:
        raise RobotDescriptionError(
            f"{path} has root links {roots}, allowed is one; hang the others on it by fixed joints"
        )

    def joints_to(link: str) -> list[ElementTree.Element]:
        steps: list[ElementTree.Element] = []
        while link in parent_joint:
            steps.append(parent_joint[link])
            link = _link(path, parent_joint[link], "parent")
            if len(steps) > len(parent_joint):
                raise RobotDescriptionError(
                    f"{path}: the joints above link {link} form a loop, allowed is a tree; remove one"
                )
        return steps[::-1]

    candidates = []
    for link in links:
        steps = joints_to(link)
        moving = [joint for joint in steps if joint.get("type") != "fixed"]
        mimics = any(joint.find("mimic") is not None for joint in moving)
        if len(moving) == JOINTS and not mimics:
            candidates.append((len(steps), link, steps))
    if not candidates:
        raise RobotDescriptionError(
            f"{path} has no chain of {JOINTS} moving joints; describe the arm alone, other joints as fixed"
        )
    _, flange, steps = max(candidates, key=lambda candidate: candidate[0])
    return roots[0], flange, steps


def _zero_position(path: Path, base: str, flange: str, steps: list[ElementTree.Element]) -> Chain:
    T_base_link = np.eye(4)
    axes, points, lower, upper = [], [], [], []
    for joint in steps:
        T_base_link = T_base_link @ _origin(path, joint)
        if joint.get("type") == "fixed":
            continue
        if joint.get("type") not in ("revolute", "continuous"):
            raise RobotDescriptionError(
                f"{path}: joint {joint.get('name')} is {joint.get('type')}, allowed is revolute; "
                "only arms whose joints all turn are supported"
            )
        axes.append(T_base_link[:3, :3] @ _axis(path, joint))
        points.append(T_base_link[:3, 3].copy())
        limit = joint.find("limit")
        lower.append(_bound(path, joint, limit, "lower", -np.inf))
        upper.append(_bound(path, joint, limit, "upper", np.inf))
    return Chain(
        base, flange, np.array(axes), np.array(points), T_base_link, np.array(lower), np.array(upper)
    )


def _bound(
    path: Path, joint: ElementTree.Element, limit: ElementTree.Element | None, name: str, default: float
) -> float:
    text = None if limit is None else limit.get(name)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if np.isnan(value):
        raise RobotDescriptionError(
            f"{path}: joint {joint.get('name')} has the {name} limit '{text}', allowed is a number; correct it"
        )
    return value


def _axis(path: Path, joint: ElementTree.Element) -> FloatArray:
    element = joint.find("axis")
    axis = _numbers(path, joint, "1 0 0" if element is None else element.get("xyz", "1 0 0"))
    norm = np.linalg.norm(axis)
    if norm < 1e-9:
        raise RobotDescriptionError(
            f"{path}: the axis of joint {joint.get('name')} has no length; correct it to a direction such as 0 0 1"
        )
    return axis / norm


def _origin(path: Path, joint: ElementTree.Element) -> FloatArray:
    element = joint.find("origin")
    if element is None:
        return np.eye(4)
    rotation = rotation_rpy(_numbers(path, joint, element.get("rpy", "0 0 0")))
    return transform(rotation, _numbers(path, joint, element.get("xyz", "0 0 0")))


def _numbers(path: Path, joint: ElementTree.Element, text: str) -> FloatArray:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if values.shape != (3,) or not np.all(np.isfinite(values)):
        raise RobotDescriptionError(
            f"{path}: joint {joint.get('name')} has '{text}' where three finite numbers belong; correct it"
        )
    return values


def _link(path: Path, joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    if element is None or not element.get("link"):
        raise RobotDescriptionError(f"{path}: joint {joint.get('name')} names no {tag} link; add one")
    return element.get("link", "")
