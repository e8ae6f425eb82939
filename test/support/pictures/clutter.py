"""Things that lie, stick or are screwed where the camera looks; seeded."""

from __future__ import annotations

import numpy as np

from doormill_ros.simulation.picture.scene import Blot, Chip, Shadow
from doormill_ros.units import DEG, MM

REACH = {"hinge": 0.080, "bottom": 0.135}  # about the length of edge in the picture [m]


def _oval(y: float, z: float, a: float, b: float, turn: float, count: int = 14) -> np.ndarray:
    w = np.arange(count) * (2 * np.pi / count)
    p, q = a * np.cos(w), b * np.sin(w)
    return np.column_stack([y + p * np.cos(turn) - q * np.sin(turn), z + p * np.sin(turn) + q * np.cos(turn)])


def on_edge(edge: str, across: float, along: float) -> tuple[float, float]:
    """Door y, z of a place given from an edge: `across` inside positive, `along` from the corner [m]."""
    return (across, along) if edge == "hinge" else (along, across)


def dust(rng: np.random.Generator, count: int) -> list[Blot]:
    """Saw dust and splinters, half of it gathered about the edges, some on the background only."""
    out = []
    for _ in range(count):
        size = min(0.12 * MM * np.exp(rng.normal(0.3, 0.7)), 1.5 * MM)
        if rng.random() < 0.5:
            edge = str(rng.choice(["hinge", "bottom"]))
            y, z = on_edge(edge, rng.normal(0, 1.5 * MM), rng.uniform(0, REACH[edge]))
        else:
            y, z = rng.uniform(-0.04, 0.14), rng.uniform(-0.03, 0.08)
        outline = _oval(y, z, size, size * rng.uniform(0.25, 1.0), rng.uniform(0, np.pi))
        out.append(Blot(outline, rng.uniform(0.15, 0.9), behind=bool(rng.random() < 0.3)))
    return out


def screw(rng: np.random.Generator) -> list[Blot]:
    """A screw head with a slot, anywhere in view."""
    y, z = rng.uniform(-0.03, 0.12), rng.uniform(-0.02, 0.07)
    radius, turn, metal = rng.uniform(2, 5) * MM, rng.uniform(0, np.pi), rng.uniform(0.4, 0.9)
    return [
        Blot(_oval(y, z, 1.1 * radius, 1.1 * radius, 0, 24), 0.5 * metal),
        Blot(_oval(y, z, radius, radius, 0, 24), metal),
        Blot(_oval(y, z, 0.8 * radius, 0.15 * radius, turn, 4), 0.15 * metal),
    ]


def clamp(rng: np.random.Generator, share: tuple[float, float] = (0.08, 0.22)) -> list[Blot]:
    """A clamp's finger that covers a share of one edge, with a bright flank."""
    edge = str(rng.choice(["hinge", "bottom"]))
    length = REACH[edge] * rng.uniform(*share)
    start = rng.uniform(0.1, 0.9 - share[1]) * REACH[edge]
    depth, skew, grey = rng.uniform(3, 25) * MM, rng.normal(0, 3 * DEG), rng.uniform(0.1, 0.8)
    corners = np.array([[-0.06, 0], [depth, 0], [depth, length], [-0.06, length]])
    corners = corners @ np.array([[np.cos(skew), np.sin(skew)], [-np.sin(skew), np.cos(skew)]]) + [0, start]
    flank = corners + np.array([[0, 0], [0, 0], [0, 0.85 * -length], [0, 0.85 * -length]])
    if edge == "bottom":
        corners, flank = corners[:, ::-1], flank[:, ::-1]
    return [Blot(corners, grey), Blot(flank, min(grey + 0.2, 0.95))]


def beam(rng: np.random.Generator) -> list[Blot]:
    """A rail of the cell behind the door, nearly parallel to one of its edges."""
    edge = str(rng.choice(["hinge", "bottom"]))
    near, wide, skew = -rng.uniform(4, 30) * MM, rng.uniform(3, 15) * MM, rng.normal(0, 1.0 * DEG)
    ends = np.array([-0.1, 0.25])
    corners = np.array(
        [
            [near + ends[0] * skew, ends[0]],
            [near + ends[1] * skew, ends[1]],
            [near - wide + ends[1] * skew, ends[1]],
            [near - wide + ends[0] * skew, ends[0]],
        ]
    )
    return [Blot(corners if edge == "hinge" else corners[:, ::-1], rng.uniform(0.05, 0.7), behind=True)]


def chips(rng: np.random.Generator, mean: float) -> list[Chip]:
    """Broken-out wood, a Poisson number on each edge."""
    out = []
    for edge, reach in REACH.items():
        for _ in range(rng.poisson(mean)):
            length = rng.uniform(0.4, 5.0) * MM
            out.append(Chip(edge, rng.uniform(0, reach), length, length * rng.uniform(0.05, 0.4)))
    return out


def shadow(rng: np.random.Generator) -> Shadow:
    """The border of a shadow somewhere across the picture."""
    return Shadow(
        (rng.uniform(-0.01, 0.1), rng.uniform(-0.01, 0.06)),
        rng.uniform(0, 2 * np.pi),
        rng.uniform(2, 30) * MM,
        rng.uniform(0.5, 0.85),
    )
