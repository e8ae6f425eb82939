"""Features of the light: shadows with borders, spots of sun, a wall on which the door casts its own."""

from __future__ import annotations

import math
from dataclasses import replace

from doormill_ros.units import DEG
from support.views.draft import Draft
from support.views.light import Lamp, Rod, Screen, Window


def _lamp_to(d: Draft, y: float, z: float, x: float) -> tuple[float, float]:
    """Where the way from a point of the face to the first lamp meets the plane x."""
    lamp = d.lamps[0].place
    share = x / lamp[0]
    return y + share * (lamp[1] - y), z + share * (lamp[2] - z)


def cable_shadow(d: Draft) -> None:
    """A cable or arm out of sight casts its shadow across an edge."""
    x, turn = d.uniform(-0.25, -0.05), d.uniform(0, math.pi)
    at = (0.0, d.uniform(0.0, 0.06)) if d.chance(0.5) else (d.uniform(0.0, 0.1), 0.0)
    y, z = _lamp_to(d, at[0], at[1], x)
    c, s = math.cos(turn), math.sin(turn)
    d.shades.append(Rod((x, y - c, z - s), (x, y + c, z + s), d.uniform(2e-3, 2.5e-2)))


def _border(d: Draft, at: float) -> None:
    """Shade one side of a straight border beside an edge, `at` inside it [m]; sharp, from a board near the door."""
    x, hinge, turn = d.uniform(-0.12, -0.02), d.chance(0.5), d.uniform(-1.0, 1.0) * DEG
    y, z = _lamp_to(d, at, 0.03, x) if hinge else _lamp_to(d, 0.05, at, x)
    c, s = math.cos(turn), math.sin(turn)
    sign = 1.0 if d.chance(0.5) else -1.0
    normal = (sign * c, sign * s) if hinge else (-sign * s, sign * c)
    d.lamps[0] = replace(d.lamps[0], radius=d.uniform(5e-3, 3e-2))
    d.shades.append(Screen(x, normal, normal[0] * y + normal[1] * z, d.uniform(0.02, 1.0)))


def shadow_inside(d: Draft) -> None:
    """A border of shadow along an edge, on the face."""
    _border(d, d.uniform(2e-3, 15e-3))


def shadow_across(d: Draft) -> None:
    """A border of shadow that lies nearly on an edge or a little outside it."""
    _border(d, d.uniform(-6e-3, 2e-3))


def shadow_outside(d: Draft) -> None:
    """A border of shadow along an edge on a wall not far behind."""
    x = d.place.thickness + d.uniform(0.01, 0.1)
    d.hang(kind=d.one_of("paint", "concrete"), x=x, albedo=d.uniform(0.3, 0.8), texel=3e-4, floor=None)
    _border(d, d.uniform(-0.04, -0.01))


def sun_spot(d: Draft) -> None:
    """Sun through a small window on a part of an edge."""
    sun = (-3.0, d.uniform(-2.0, 2.0), d.uniform(0.5, 3.0))
    at = (
        (d.uniform(-0.005, 0.005), d.uniform(0.0, 0.06))
        if d.chance(0.5)
        else (d.uniform(0, 0.1), d.uniform(-0.005, 0.005))
    )
    x = d.uniform(-1.0, -0.3)
    share = x / sun[0]
    middle = (at[0] + share * (sun[1] - at[0]), at[1] + share * (sun[2] - at[1]))
    opening = Window(x, middle, (d.uniform(0.005, 0.04), d.uniform(0.01, 0.06)), d.uniform(-0.8, 0.8))
    d.lamps.append(Lamp(sun, d.uniform(0.5, 2.5), 0.015, opening))


def wall_close(d: Draft) -> None:
    """A wall right behind the door, on which two lamps cast its double shadow."""
    d.hang(
        kind=d.one_of("paint", "concrete"),
        x=d.place.thickness + d.uniform(4e-3, 0.08),
        albedo=d.uniform(0.3, 0.85),
        texel=3e-4,
    )
    d.hang(floor=None)
    side = d.uniform(0.4, 1.2)
    d.lamps = [
        Lamp((d.uniform(-1.2, -0.4), side, d.uniform(0.2, 1.2)), d.uniform(0.5, 1.0), d.uniform(3e-3, 4e-2)),
        Lamp(
            (d.uniform(-1.2, -0.4), d.uniform(-0.6, 0.9), d.uniform(0.3, 1.2)),
            d.uniform(0.3, 1.0),
            d.uniform(3e-3, 4e-2),
        ),
    ]
