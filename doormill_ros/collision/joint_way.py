"""A way through joint space from one posture to another past everything in the cell.

Simple ways are tried first: straight, then by way of postures that are likely to help. Where none of them is free
two trees grow towards each other from both ends (RRT-Connect, Kuffner and LaValle 2000), from a fixed seed, so that
the same door always gets the same way.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.collision.sweep import Contact, contact_along, contact_at, meets_again
from doormill_ros.collision.world import World

STRIDE = 0.6  #: longest edge of a tree, over all joints [rad]
ROUNDS = 300  #: postures that are drawn before a way is given up
SHORTCUTS = 30
SEED = 20


def joint_way(
    world: World,
    start: FloatArray,
    end: FloatArray,
    by_way_of: Iterable[list[FloatArray]] = (),
    limits: tuple[FloatArray, FloatArray] | None = None,
) -> list[FloatArray] | Contact:
    """The postures between two, joint by joint on straight lines from each to the next.

    Args:
        world: The bodies.
        start: Shape (6,) [rad].
        end: Shape (6,) [rad].
        by_way_of: Postures to try in turn where the straight way is not free, each of shape (6,) [rad].
        limits: Lowest and highest joint angles of a searched way, shape (6,) each [rad]; None for no search.

    Returns:
        Postures between the two, none for a straight way; or what is in the way of the straight one.
    """
    straight = contact_along(world, np.array([start, end]))
    if straight is None:
        return []
    met = straight
    for between in by_way_of:
        way = np.array([start, *between, end])
        if meets_again(world, way, met):
            continue
        touching = [contact for contact in (contact_at(world, q) for q in between) if contact is not None]
        found = touching[0] if touching else contact_along(world, way)
        if found is None:
            return between
        met = found
    if limits is None or contact_at(world, start) or contact_at(world, end):
        return straight
    searched = _Search(world, *limits).way(start, end)
    return straight if searched is None else searched


class _Tree:
    """Postures reached from one end, and the posture that each was reached from."""

    def __init__(self, root: FloatArray) -> None:
        self.q = [root]
        self.parent = [-1]

    def nearest(self, q: FloatArray) -> int:
        return int(np.linalg.norm(np.array(self.q) - q, axis=1).argmin())

    def add(self, q: FloatArray, parent: int) -> int:
        self.q.append(q)
        self.parent.append(parent)
        return len(self.q) - 1

    def back(self, index: int) -> list[FloatArray]:
        """From a posture to the root."""
        way = []
        while index >= 0:
            way.append(self.q[index])
            index = self.parent[index]
        return way


class _Search:
    """RRT-Connect between two postures."""

    def __init__(self, world: World, lower: FloatArray, upper: FloatArray) -> None:
        self.world = world
        self.lower, self.upper = lower, upper
        self.random = np.random.default_rng(SEED)

    def way(self, start: FloatArray, end: FloatArray) -> list[FloatArray] | None:
        """Postures between start and end, None where none was found."""
        here, there = _Tree(start), _Tree(end)
        # Ways of this kind leave the box between both ends by little; now and then anything is tried.
        low, high = np.minimum(start, end) - 0.7, np.maximum(start, end) + 0.7
        low, high = np.maximum(low, self.lower), np.minimum(high, self.upper)
        for number in range(ROUNDS):
            wide = number % 4 == 3
            drawn = self.random.uniform(self.lower if wide else low, self.upper if wide else high)
            new = self._grow(here, drawn)
            if new is not None:
                met = self._reach(there, here.q[new])
                if met is not None:
                    way = [*here.back(new)[::-1], *there.back(met)[1:]]
                    forward = way if way[0] is start else way[::-1]
                    return self._shortened(forward)[1:-1]
            here, there = there, here
        return None

    def _free(self, *q: FloatArray) -> bool:
        return contact_along(self.world, np.array(q)) is None

    def _grow(self, tree: _Tree, towards: FloatArray) -> int | None:
        """One edge towards a posture; the new one's number, None where something is in the way."""
        nearest = tree.nearest(towards)
        step = towards - tree.q[nearest]
        length = float(np.linalg.norm(step))
        new = towards if length <= STRIDE else tree.q[nearest] + step * (STRIDE / length)
        return tree.add(new, nearest) if self._free(tree.q[nearest], new) else None

    def _reach(self, tree: _Tree, goal: FloatArray) -> int | None:
        """Edge after edge up to a posture; its number in the tree, None where something is in the way."""
        while True:
            new = self._grow(tree, goal)
            if new is None or tree.q[new] is goal:
                return new

    def _shortened(self, way: list[FloatArray]) -> list[FloatArray]:
        """The way without the postures that it can do without."""
        for _ in range(SHORTCUTS):
            spans = [(i, j) for i, j in itertools.combinations(range(len(way)), 2) if j - i > 1]
            span = next(
                ((i, j) for i, j in sorted(spans, key=lambda s: s[0] - s[1]) if self._free(way[i], way[j])),
                None,
            )
            if span is None:
                break
            way = [*way[: span[0] + 1], *way[span[1] :]]
        return way
