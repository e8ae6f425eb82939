"""Features of how the picture is taken: a soiled window, a door that swings, lamps on the mains."""

from __future__ import annotations

import math

from support.views.draft import Draft
from support.views.view import Blot


def dirt(d: Draft) -> None:
    """Dark spots far out of focus."""
    spots = [
        Blot(
            d.uniform(100, 1800),
            d.uniform(50, 1000),
            d.uniform(15, 90),
            d.uniform(20, 80),
            d.uniform(0.15, 0.7),
        )
        for _ in range(int(d.rng.integers(1, 4)))
    ]
    d.take(blots=(*d.taking.blots, *spots))


def drop_on_window(d: Draft) -> None:
    """A drop of water on the window, which bends the picture."""
    at = (
        (d.uniform(300, 1500), 757.0 + d.uniform(-60, 60))
        if d.chance(0.5)
        else (1396.0 + d.uniform(-60, 60), d.uniform(50, 700))
    )
    blot = Blot(
        *at,
        d.uniform(30, 110),
        d.uniform(25, 50),
        d.uniform(0.05, 0.2),
        0.01,
        d.uniform(2, 10) * d.one_of(-1, 1),
    )
    d.take(blots=(*d.taking.blots, blot))


def lens_dust(d: Draft) -> None:
    """Many faint specks."""
    specks = [
        Blot(
            d.uniform(0, 1919), d.uniform(0, 1079), d.uniform(6, 20), d.uniform(8, 20), d.uniform(0.03, 0.12)
        )
        for _ in range(15)
    ]
    d.take(blots=(*d.taking.blots, *specks))


def motion(d: Draft) -> None:
    """A door that still swings."""
    size, way = d.uniform(1.0, 2.2), d.uniform(0, math.pi)
    d.take(motion=(size * math.cos(way), size * math.sin(way)))


def flicker(d: Draft) -> None:
    """Bands of a lamp on the mains."""
    d.take(flicker=(d.uniform(0.03, 0.15), d.uniform(60, 500)))


def uneven_light(d: Draft) -> None:
    """A third of the light is lost across the picture."""
    d.take(uneven=(d.uniform(0.2, 0.4), d.uniform(0, 2 * math.pi)))


def soft_focus(d: Draft) -> None:
    """The face a little out of focus."""
    d.take(focus=d.uniform(0.005, 0.03) * d.one_of(-1, 1), aperture=d.uniform(1e-3, 2e-3))
