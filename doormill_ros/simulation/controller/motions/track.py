"""A path as a row of nodes, and the speed at which it can be driven.

The way between two nodes is measured so that one acceleration bounds tool and joints: it is the way of the tool [m],
or a joint's angle times `radius` where a joint has further to go, with `radius` = tool acceleration / joint
acceleration. Speeds come from one pass backwards (the robot must be able to stop where its known path ends) and one
forwards, with constant acceleration between nodes (time-optimal path parameterization, e.g. Pham and Pham 2018).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.moves import MotionContext

#: Ways below this are standing still [m].
STILL = 1e-9


@dataclass(slots=True, eq=False)
class PathNode:
    """A place on the path, and the way from it to the next one.

    Attributes:
        q: Joint angles, shape (6,) [rad].
        pose: T_base_tool, shape (4, 4).
        context: What the motion is for.
        serial: Number of the motion that it belongs to.
        way: To the next node [m].
        tool: Way of the tool to the next node [m].
        programmed: Programmed speed on the way to the next node [m/s of way].
        drive: Speed at which the drives can follow there [m/s of way].
        bend: Largest speed through the node, for the bend that the path has in it [m/s of way].
        dwell: Time that the robot stands here [s].
        stop: Whether it comes to rest here.
        speed: Speed with which it passes [m/s of way].
    """

    q: FloatArray
    pose: FloatArray
    context: MotionContext
    serial: int
    way: float = 0.0
    tool: float = 0.0
    programmed: float = np.inf
    drive: float = np.inf
    bend: float = np.inf
    dwell: float = 0.0
    stop: bool = False
    speed: float = 0.0


class SpeedRules:
    """How fast a path may be driven: limits of the drives, override and manual speed."""

    def __init__(self, limits: ControllerLimits, max_velocity: FloatArray) -> None:
        """Take the limits and the largest joint speeds, shape (6,) [rad/s]."""
        self.limits = limits
        self.acceleration = limits.acceleration
        with np.errstate(divide="ignore"):
            self.radius = limits.acceleration * limits.ramp / max_velocity  # (6,) [m]
        self.max_velocity = max_velocity
        #: Share of the programmed speed, 0 to 1, and the largest speed of the tool [m/s].
        self.override = 1.0
        self.tool_speed = np.inf

    def cap(self, node: PathNode) -> float:
        """Largest speed on the way from a node to the next one [m/s of way]."""
        speed = min(node.programmed * self.override, node.drive)
        if node.tool > STILL:
            speed = min(speed, self.tool_speed * node.way / node.tool)
        return speed

    def nodes(
        self,
        time: FloatArray,
        poses: FloatArray,
        q: FloatArray,
        contexts: Sequence[MotionContext],
        serials: Sequence[int],
    ) -> list[PathNode]:
        """Nodes of a stretch of path, with the speeds that its geometry allows.

        Args:
            time: When each would be passed at the programmed speed, shape (n,) [s].
            poses: T_base_tool, shape (n, 4, 4).
            q: Joint angles, shape (n, 6) [rad].
            contexts: What the motion is for, n of them.
            serials: Number of the motion, n of them.
        """
        made = [PathNode(*parts) for parts in zip(q, poses, contexts, serials, strict=True)]
        self._measure(made, time)
        return made

    def _measure(self, made: list[PathNode], time: FloatArray) -> None:
        q = np.array([node.q for node in made])
        points = np.array([node.pose[:3, 3] for node in made])
        joints, steps = np.diff(q, axis=0), np.diff(points, axis=0)
        tool = np.linalg.norm(steps, axis=1)
        way = np.maximum(tool, (np.abs(joints) * self.radius).max(axis=1, initial=0.0))
        still = way < STILL
        with np.errstate(divide="ignore", invalid="ignore"):
            programmed = np.where(still, np.inf, way / np.diff(time))
            slowest = (np.abs(joints) / self.max_velocity).max(axis=1, initial=0.0)
            drive = np.where(still | (slowest == 0.0), np.inf, way / slowest)
        for node, w, t, p, d in zip(made[:-1], way, tool, programmed, drive, strict=True):
            node.way, node.tool, node.programmed, node.drive = float(w), float(t), float(p), float(d)
        self.bend(made)

    def bend(self, row: Sequence[PathNode]) -> None:
        """Set the speeds through the inner nodes of a row, from the bend of the path in them."""
        if len(row) < 3:
            return
        way = np.array([node.way for node in row[:-1]])
        if way.max() < STILL:
            return
        q = np.array([node.q for node in row])
        points = np.array([node.pose[:3, 3] for node in row])
        safe = np.maximum(way, STILL)[:, None]
        along = np.concatenate(
            [np.diff(points, axis=0) / safe, np.diff(q, axis=0) * self.radius / safe], axis=1
        )
        change = np.diff(along, axis=0)
        bend = np.maximum(np.linalg.norm(change[:, :3], axis=1), np.abs(change[:, 3:]).max(axis=1))
        mean = 0.5 * (way[:-1] + way[1:])
        with np.errstate(divide="ignore"):
            by_way = np.sqrt(self.acceleration * mean / np.maximum(bend, 1e-12))
            by_servo = self.acceleration * self.limits.servo / np.maximum(bend, 1e-12)
        speeds = np.where((way[:-1] < STILL) | (way[1:] < STILL), np.inf, np.maximum(by_way, by_servo))
        for node, speed in zip(row[1:-1], speeds, strict=True):
            node.bend = float(speed)

    def profile(self, row: Sequence[PathNode], deceleration: float | None = None) -> None:
        """Set the speeds along a row; the first node keeps its speed, the last one is a stop.

        Args:
            row: Nodes from the one that is passed next on.
            deceleration: Brake with this to a stop as soon as it goes [m/s^2]; None drives on.
        """
        a = self.acceleration
        allowed = [0.0] * len(row)
        caps = [self.cap(node) for node in row[:-1]]
        for k in range(len(row) - 2, 0, -1):
            node = row[k]
            if not (node.stop or node.dwell > 0.0):
                cap = min(caps[k - 1], caps[k], node.bend)
                allowed[k] = min(cap, sqrt(allowed[k + 1] ** 2 + 2.0 * a * node.way))
        for k in range(len(row) - 1):
            square = row[k].speed ** 2
            if deceleration is not None:
                slowest = max(0.0, square - 2.0 * deceleration * row[k].way)
                row[k + 1].speed = sqrt(min(slowest, allowed[k + 1] ** 2))
                continue
            slowest = max(0.0, square - 2.0 * a * self.limits.quick_factor * row[k].way)
            fastest = square + 2.0 * a * row[k].way
            row[k + 1].speed = sqrt(min(max(allowed[k + 1] ** 2, slowest), fastest))

    def time_between(self, node: PathNode, following: PathNode) -> float:
        """Time from a node to the next one [s], standing at the first one left out."""
        if node.way < STILL:
            return 0.0
        both = node.speed + following.speed
        if both > 0.0:
            return 2.0 * node.way / both
        cap = self.cap(node)
        if cap <= 0.0:
            return float("inf")
        # From rest to rest: up to the middle and down again, or at the cap in between.
        ramp = cap**2 / self.acceleration
        if node.way <= ramp:
            return 2.0 * sqrt(node.way / self.acceleration)
        return cap / self.acceleration + node.way / cap


def split(node: PathNode, following: PathNode, share: float) -> PathNode:
    """A node at `share` of the way between two; its pose and angles lie on the straight line between theirs."""
    pose = node.pose + share * (following.pose - node.pose)
    # The turn between two nodes is small, so the mean of the rotations is one up to second order.
    u, _, v = np.linalg.svd(pose[:3, :3])
    pose[:3, :3] = u @ v
    middle = PathNode(
        node.q + share * (following.q - node.q),
        pose,
        node.context,
        node.serial,
        way=(1.0 - share) * node.way,
        tool=(1.0 - share) * node.tool,
        programmed=node.programmed,
        drive=node.drive,
    )
    node.way, node.tool = share * node.way, share * node.tool
    return middle
