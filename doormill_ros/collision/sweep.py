"""Prove that a motion keeps every pair of bodies apart, or find where it does not.

No body's point moves further than the sum of the joints' turns, each times its reach. So one posture with known
distances proves every posture near it, and a motion is done when such neighbourhoods cover it: nothing between
samples is left to luck.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.collision.world import World

#: At a posture that is looked at all pairs keep this much more than the clearance, so that each proves some way on [m].
RESERVE = 0.002
CONVEX = 5  #: places that are looked at on a straight way of the tool
MOST = 20_000  #: postures; more than any way within a cell takes


@dataclass(frozen=True, eq=False)
class Contact:
    """Where a motion brings two bodies too close.

    Attributes:
        body: What moves.
        obstacle: What it comes close to.
        distance: Between them, negative where they overlap [m].
        q: The posture, shape (6,) [rad].
    """

    body: str
    obstacle: str
    distance: float
    q: FloatArray

    @property
    def what(self) -> str:
        """The two bodies, for a sentence."""
        return f"{self.body} and {self.obstacle}"


def contact_at(world: World, q: FloatArray, cutting: bool = False) -> Contact | None:
    """The pair that is closest in one posture, None where all keep the clearance; q of shape (6,) [rad]."""
    pairs = np.flatnonzero(world.outside_cut) if cutting else np.arange(len(world.names))
    found = world.distances(q)[pairs]
    worst = int(found.argmin())
    if found[worst] >= world.clearance + RESERVE:
        return None
    body, obstacle = world.names[pairs[worst]]
    return Contact(body, obstacle, float(found[worst]), np.array(q))


def contact_along(
    world: World,
    q: FloatArray,
    bulge: FloatArray | None = None,
    *,
    cutting: bool = False,
    pairs: IntArray | None = None,
) -> Contact | None:
    """The first contact found on a way through postures, None where it is proven that there is none.

    Args:
        world: The bodies.
        q: Postures, joint by joint on a straight line from each to the next, shape (n, 6) [rad].
        bulge: How far each joint may leave those lines, shape (n - 1, 6) [rad]; None for not at all.
        cutting: The mill is in the wood, so only pairs outside the cut count.
        pairs: Which pairs count; None for all of them.
    """
    if pairs is None:
        pairs = np.flatnonzero(world.outside_cut) if cutting else np.arange(len(world.names))
    start, end = q[:-1], q[1:]
    off = np.zeros_like(start) if bulge is None else bulge
    reach = world.reach[pairs].T  # (6, pairs)
    size = _size(start, end, reach)
    for count in range(MOST):
        # The ends first, then the middle of what is longest: what is in the way is found soon.
        at = -1
        if count < 2:
            here = q[-1] if count == 0 else q[0]
        else:
            longest = (size > 0.9 * size.max()).nonzero()[0]
            at = int(longest[len(longest) // 2])
            here = 0.5 * (start[at] + end[at])
        distance = world.distances(here)[pairs]
        worst = int(distance.argmin())
        spare = distance - world.clearance
        if spare[worst] < RESERVE or (at >= 0 and size[at] < 0.1 * RESERVE):
            # In the second case only what the way may leave its line by is too much: as good as a contact.
            body, obstacle = world.names[pairs[worst]]
            return Contact(body, obstacle, float(distance[worst]), here)
        done = _within(np.concatenate([start, end]) - here, np.concatenate([off, off]), reach, spare)
        done = done[: len(start)] & done[len(start) :]
        if at >= 0 and not done[at]:
            keep = ~done
            keep[at] = False
            start = np.concatenate([start[keep], start[at : at + 1], here[None]])
            end = np.concatenate([end[keep], here[None], end[at : at + 1]])
            off = np.concatenate([off[keep], off[[at, at]]])
            size = np.concatenate([size[keep], [0.5 * size[at]] * 2])
        elif done.any():
            keep = ~done
            start, end, off, size = start[keep], end[keep], off[keep], size[keep]
        if not len(start):
            return None
    raise AssertionError("a way takes more postures than any can")


def contact_on_line(world: World, q: FloatArray, fraction: FloatArray) -> Contact | None:
    """As `contact_along`, for a way on which the tool keeps its direction and goes straight.

    Along it the distance between a body on the flange and one that stands still is a convex function of the way:
    between two places it is nowhere below the lines through the places beside them. A few places so prove a tool
    that goes along close to a surface, where neighbourhoods would be small.

    Args:
        world: The bodies.
        q: Postures along the way, shape (n, 6) [rad], n >= 5.
        fraction: Fractions 0..1 of the way, shape (n,).
    """
    rows = np.linspace(0, len(q) - 1, CONVEX).round().astype(int)
    tool = np.flatnonzero(world.tool_and_cell)
    found, t = np.array([world.distances(q[i])[tool] for i in rows]), fraction[rows, None]
    slope = np.diff(found, axis=0) / np.diff(t, axis=0)  # (CONVEX - 1, pairs)
    # From the left the slope before goes on, from the right the one behind; at the ends there is one of them only.
    left = found[1:-1] + slope[:-1] * (t[2:] - t[1:-1])  # at the right end of intervals 1 .. CONVEX - 2
    right = found[1:-1] - slope[1:] * (t[1:-1] - t[:-2])  # at the left end of intervals 0 .. CONVEX - 3
    lowest = np.concatenate([found.min(axis=0)[None], left.min(axis=0)[None], right.min(axis=0)[None]])
    proven = lowest.min(axis=0) >= world.clearance
    if (found < world.clearance + RESERVE).any():
        place, worst = np.unravel_index(found.argmin(), found.shape)
        body, obstacle = world.names[tool[worst]]
        return Contact(body, obstacle, float(found[place, worst]), q[rows[place]])
    rest = np.setdiff1d(np.arange(len(world.names)), tool[proven])
    return contact_along(world, q, bulge_of(q), pairs=rest)


def _size(start: FloatArray, end: FloatArray, reach: FloatArray) -> FloatArray:
    """How far a body may move on each part of a way, shape (m,) [m]."""
    size: FloatArray = (np.abs(end - start) @ reach).max(axis=1)
    return size


def _within(step: FloatArray, off: FloatArray, reach: FloatArray, spare: FloatArray) -> BoolArray:
    """Which postures a posture proves, by their joint angles from it, shape (m, 6) -> (m,)."""
    pair: BoolArray = (np.abs(step) + off) @ reach <= spare
    near: BoolArray = np.logical_and.reduce(pair, axis=1)
    return near


def bulge_of(q: FloatArray) -> FloatArray:
    """How far a smooth way through postures may leave the lines between them, shape (n, 6) -> (n - 1, 6) [rad].

    Of a curve an eighth of the second difference lies between it and its chord; twice that is taken, and
    where a way is looked at from two sides the larger.
    """
    if len(q) < 3:
        return np.zeros((len(q) - 1, q.shape[1]))
    bend = np.abs(np.diff(q, n=2, axis=0)) / 4.0  # (n - 2, 6)
    first, last = np.concatenate([bend[:1], bend]), np.concatenate([bend, bend[-1:]])
    larger: FloatArray = np.maximum(first, last)
    return larger
