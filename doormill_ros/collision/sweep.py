"""Prove that a motion keeps every pair of bodies apart, or find where it does not.

No body's point moves further than the sum of the joints' turns, each times its reach, and a plane between two bodies
tells more (`separation`). So one posture with known distances proves parts of the motion far and near, and a motion is
done when they cover it: nothing between samples is left to luck. A pair that is proven on a part of the motion is not
looked at there again.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.collision.world import World

#: At a posture that is looked at all pairs keep this much more than the clearance, so that each proves some way on [m].
RESERVE = 0.002
#: A way without a bulge keeps that all along but for this: the verdict does not hang on where it is looked at [m].
HAIR = 1e-5
#: By as much bodies may be off their chords between the postures that a way is looked at in one go [m].
BEND = 0.004
LOOKS = 16  #: at each part of a way before much is spent on it
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


def contact_at(world: World, q: FloatArray) -> Contact | None:
    """The pair that is closest in one posture, None where all keep the clearance; q of shape (6,) [rad]."""
    return _contact_of(world, q, np.arange(len(world.names)))


def meets_again(world: World, q: FloatArray, found: Contact) -> bool:
    """Whether two bodies that met elsewhere meet on a way too, as far as a few looks tell.

    Args:
        world: The bodies.
        q: Postures, as for `contact_along`.
        found: Where they met.
    """
    pair = np.array([world.names.index((found.body, found.obstacle))])
    share = (np.arange(LOOKS) + 0.5)[:, None, None] / LOOKS
    looked = (q[:-1] + share * (q[1:] - q[:-1])).reshape(-1, q.shape[1])
    return any(world.distances(here, pair)[0] < world.clearance + RESERVE for here in looked)


def contact_along(
    world: World,
    q: FloatArray,
    bulge: FloatArray | None = None,
    *,
    pairs: IntArray | None = None,
) -> Contact | None:
    """The first contact found on a way through postures, None where it is proven that there is none.

    Args:
        world: The bodies.
        q: Postures, joint by joint on a straight line from each to the next, shape (n, 6) [rad].
        bulge: How far each joint may leave those lines, shape (n - 1, 6) [rad]; None for not at all.
        pairs: Which pairs count; None for all of them.
    """
    if pairs is None:
        pairs = np.arange(len(world.names))
    needed = world.clearance + (RESERVE - HAIR if bulge is None else 0.0)
    ways = deque([(q, bulge, pairs)] if len(pairs) else [])
    looks = 0
    while ways:
        # Long parts come first, so that what is in the way is found soon.
        q, off, pairs = ways.popleft()
        q, off, at = _divided(world, q, off)
        parts = np.arange(len(q) - 1)[:, None] + np.arange(2)
        region = world.region(q, parts, off)
        left = np.ones((len(pairs), len(parts)), dtype=bool)
        rest: dict[int, IntArray] = {}
        while left.any():
            looks += 1
            if looks > MOST:
                raise AssertionError("a way takes more postures than any can")
            beside = range(max(at - 1, 0), min(at + 1, len(parts)))
            own = np.flatnonzero(left[:, beside].any(axis=1))
            distance = world.distances(q[at], pairs[own])
            if distance.min() < world.clearance + RESERVE:
                return _contact(world, pairs[own], distance, q[at])
            left[own] &= world.lowest(pairs[own], distance, q[at], region, needed) < needed
            for part in beside:
                if left[:, part].any():
                    if float(np.abs(q[part + 1] - q[part]) @ world.farthest) < 0.1 * RESERVE:
                        # Only what the way may leave its line by is too much: as good as a contact.
                        return _contact(world, pairs[own], distance, q[at])
                    rest[part] = pairs[left[:, part]]
                    left[:, part] = False
            if left.any():
                # In the middle of where the pair that is proven least is not proven yet.
                open_ = np.flatnonzero(left[left.sum(axis=1).argmax()])
                at = int(open_[len(open_) // 2])
        ways += [(q[i : i + 2], None if off is None else off[i : i + 1], own) for i, own in rest.items()]
    return None


def _divided(
    world: World, q: FloatArray, off: FloatArray | None
) -> tuple[FloatArray, FloatArray | None, int]:
    """A way in parts so short that bodies hardly bend off their chords, and the number of the posture in its middle.

    Args:
        world: The bodies.
        q: Postures, shape (n, 6) [rad].
        off: As `contact_along`'s bulge.
    """
    way_of_part = q[1:] - q[:-1]
    turn = np.abs(way_of_part)
    count = np.ceil(np.sqrt(world.bend(turn) / BEND)).astype(int).clip(1)
    way = (turn @ world.farthest).cumsum()
    middle = int(way.searchsorted(0.5 * way[-1]))
    count[middle] += count[middle] % 2
    at = int(count[:middle].sum() + count[middle] // 2)
    part = np.arange(len(turn)).repeat(count)
    share = (np.arange(len(part)) - (count.cumsum() - count)[part]) / count[part]
    places = np.concatenate([q[part] + share[:, None] * way_of_part[part], q[-1:]])
    return places, None if off is None else off[part], at


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
    found, t = np.array([world.distances(q[i], tool) for i in rows]), fraction[rows, None]
    slope = np.diff(found, axis=0) / np.diff(t, axis=0)  # (CONVEX - 1, pairs)
    # From the left the slope before goes on, from the right the one behind; at the ends there is one of them only.
    left = found[1:-1] + slope[:-1] * (t[2:] - t[1:-1])  # at the right end of intervals 1 .. CONVEX - 2
    right = found[1:-1] - slope[1:] * (t[1:-1] - t[:-2])  # at the left end of intervals 0 .. CONVEX - 3
    lowest = np.concatenate([found.min(axis=0)[None], left.min(axis=0)[None], right.min(axis=0)[None]])
    proven = lowest.min(axis=0) >= world.clearance
    if (found < world.clearance + RESERVE).any():
        place = int(found.min(axis=1).argmin())
        return _contact(world, tool, found[place], q[rows[place]])
    rest = np.ones(len(world.names), dtype=bool)
    rest[tool[proven]] = False
    return contact_along(world, q, bulge_of(q), pairs=np.flatnonzero(rest))


def _contact_of(world: World, q: FloatArray, pairs: IntArray) -> Contact | None:
    """The closest of some pairs in a posture, None where all keep the clearance; shapes (6,) [rad], (n,)."""
    if not len(pairs):
        return None
    distance = world.distances(q, pairs)
    return _contact(world, pairs, distance, q) if distance.min() < world.clearance + RESERVE else None


def _contact(world: World, pairs: IntArray, distance: FloatArray, q: FloatArray) -> Contact:
    worst = int(distance.argmin())
    body, obstacle = world.names[pairs[worst]]
    return Contact(body, obstacle, float(distance[worst]), np.array(q))


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
