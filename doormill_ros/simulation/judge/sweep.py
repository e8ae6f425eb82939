"""The robot between its samples, and bodies swept against a box without gaps.

Between two samples the joints are taken to run straight, and what the loaded robot gives way is blended from the
one to the other. No point of a body moves further between two places of the path than the sum, over the joints, of
the angle turned through times the point's largest distance from the joint's axis. Two bodies whose gaps at both
places add up to more than that way were apart in between; elsewhere the stretch is halved until it is shorter
than STEP. A graze shallower than half of STEP can stay unseen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.links import FLANGE, Links

STEP = 1e-3  #: no point of a body moves further between two looks [m]
STRIDE = 32  #: samples between the first looks
LEVER = 0.5  #: no point of spindle or mill is farther from the tool centre point than this [m]


@dataclass(frozen=True, eq=False)
class Meeting:
    """Where a body met an obstacle.

    Attributes:
        place: Places in order, shape (k,).
        depth: How deep it was there, shape (k,) [m].
        samples: The samples among and between them.
    """

    place: FloatArray
    depth: FloatArray
    samples: frozenset[int]

    def only(self, kept: BoolArray) -> Meeting:
        """The meeting at some of its places, shape (k,)."""
        if kept.all():
            return self
        left = frozenset(np.floor(self.place[kept]).astype(int).tolist())
        return Meeting(self.place[kept], self.depth[kept], left)


@dataclass(frozen=True, eq=False)
class Sweep:
    """An executed path at any place between its samples.

    A place is a number of a sample with a fraction: 12.5 is half-way from sample 12 to sample 13.

    Attributes:
        links: The arm.
        q: Joint angles, shape (n, 6) [rad].
        bent: What brings the commanded tool to where it was, in base, shape (n, 4, 4).
        T_flange_tool: Shape (4, 4).
        turned: Angle that each joint has turned through since the start, shape (n, 6) [rad].
        gave: Way that spindle and mill have given since the start beyond the joints' motion, shape (n,) [m].
    """

    links: Links
    q: FloatArray
    bent: FloatArray
    T_flange_tool: FloatArray
    turned: FloatArray
    gave: FloatArray

    @cached_property
    def first(self) -> FloatArray:
        """Places of the first looks, the same for all bodies, shape (m,)."""
        return np.unique(np.append(np.arange(0, len(self), STRIDE), len(self) - 1)).astype(float)

    @cached_property
    def _at_first(self) -> dict[str, FloatArray]:
        return self.links.frames(_blend(self.q, self.first))

    @classmethod
    def of(cls, links: Links, executed: ExecutedPath, T_flange_tool: FloatArray) -> Sweep:
        """The path of a robot.

        Args:
            links: The arm.
            executed: What it did.
            T_flange_tool: Shape (4, 4).
        """
        commanded = links.frames(executed.q)[FLANGE] @ T_flange_tool
        bent = executed.T_base_tool @ inverse(commanded)
        at_tool = bent @ commanded
        change = np.linalg.norm(np.diff(at_tool[:, :3, 3] - commanded[:, :3, 3], axis=0), axis=1)
        tilt = np.linalg.norm(np.diff(bent[:, :3, :3], axis=0), axis=(1, 2))
        return cls(
            links,
            executed.q,
            bent,
            T_flange_tool,
            _summed(np.abs(np.diff(executed.q, axis=0))),
            _summed((change + LEVER * tilt)[:, None])[:, 0],
        )

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.q)

    def link(self, name: str, place: FloatArray) -> FloatArray:
        """Pose of a link in base at places (m,), shape (m, 4, 4); the flange as the loaded robot holds it."""
        frames = self._at_first if place is self.first else self.links.frames(_blend(self.q, place))
        at = frames[name]
        return _blend(self.bent, place) @ at if name == FLANGE else at

    def tool(self, place: FloatArray) -> FloatArray:
        """Pose of the tool in base at places (m,), shape (m, 4, 4)."""
        return self.link(FLANGE, place) @ self.T_flange_tool

    def way(self, link: str, extent: float, first: FloatArray, last: FloatArray) -> FloatArray:
        """How far any point within `extent` [m] of a link's origin moves between places at most, shape (m,) [m]."""
        way = (_blend(self.turned, last) - _blend(self.turned, first)) @ self.links.reach(link, extent)
        if link == FLANGE:
            way = way + _blend(self.gave, last) - _blend(self.gave, first)
        return way

    def met(
        self, link: str, extent: float, gap_at: Callable[[FloatArray], FloatArray], allowed: float = 0.0
    ) -> Meeting:
        """Where a body is deeper in an obstacle than allowed, no two looks more than STEP apart.

        Args:
            link: The body's link.
            extent: How far its farthest point is from the link's origin [m].
            gap_at: Gap between body and obstacle at places (m,), shape (m,) [m].
            allowed: Depth up to which nothing is said [m].
        """
        place = self.first
        gap = gap_at(place) + allowed
        places, gaps = [place], [gap]
        ends = np.stack([place[:-1], place[1:]], axis=1)
        at_ends = np.stack([gap[:-1], gap[1:]], axis=1)
        while len(ends):
            way = self.way(link, extent, ends[:, 0], ends[:, 1])
            open_ = (at_ends.sum(axis=1) <= way) & (way > STEP)
            ends, at_ends = ends[open_], at_ends[open_]
            if not len(ends):
                break
            # Whole samples first, fractions of them after that.
            middle = ends.mean(axis=1)
            middle = np.where(ends[:, 1] - ends[:, 0] > 1.0, np.floor(middle), middle)
            gap = gap_at(middle) + allowed
            places.append(middle)
            gaps.append(gap)
            ends = np.concatenate([np.stack([ends[:, 0], middle], 1), np.stack([middle, ends[:, 1]], 1)])
            at_ends = np.concatenate([np.stack([at_ends[:, 0], gap], 1), np.stack([gap, at_ends[:, 1]], 1)])
        found, depth = np.concatenate(places), np.concatenate(gaps)
        order = np.argsort(found, kind="stable")
        found, depth = found[order], depth[order]
        met = depth < 0.0
        return Meeting(found[met], allowed - depth[met], frozenset(between(found, met)))


def between(place: FloatArray, hit: BoolArray) -> set[int]:
    """Whole samples that were hit: those at or before a hit, and those between two hits in a row.

    Args:
        place: Places looked at, in order, shape (m,).
        hit: What the looks said, shape (m,).
    """
    samples = set(np.floor(place[hit]).astype(int).tolist())
    for first in np.flatnonzero(hit[:-1] & hit[1:]):
        samples.update(range(int(np.ceil(place[first])), int(place[first + 1]) + 1))
    return samples


def _summed(steps: FloatArray) -> FloatArray:
    return np.concatenate([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)])


def _blend(values: FloatArray, place: FloatArray) -> FloatArray:
    """Values (n, ...) at places (m,), straight between samples."""
    low = np.minimum(place.astype(int), len(values) - 1)
    high = np.minimum(low + 1, len(values) - 1)
    share = (place - low).reshape(-1, *[1] * (values.ndim - 1))
    blended: FloatArray = values[low] + share * (values[high] - values[low])
    return blended
