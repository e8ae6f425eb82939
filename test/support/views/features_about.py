"""Features about the door: what stands behind it or hangs before it."""

from __future__ import annotations

import math

from doormill_ros.units import DEG
from support.views.draft import Draft
from support.views.finish import Finish
from support.views.light import Rod
from support.views.solids import Bar, Box


def second_door(d: Draft) -> None:
    """Another leaf close behind, in the next place of a stack, shifted and a little turned."""
    x = d.place.thickness + d.uniform(5e-3, 0.12)
    y, z = d.uniform(-0.03, 0.01), d.uniform(-0.03, 0.01)
    turn = d.uniform(-1.5, 1.5) * DEG
    d.behind.append(Box((x + 0.02, y + 0.5, z + 1.0), (0.02, 0.5, 1.0), d.some_finish(d.finish.albedo), turn))


def board_stack(d: Draft) -> None:
    """Boards that lie flat below and behind the bottom edge."""
    z, x = d.uniform(-0.06, -0.02), d.place.thickness + d.uniform(0.0, 0.06)
    for _ in range(4):
        half = d.uniform(5e-3, 1.1e-2)
        finish = d.some_finish(kinds=("pine", "beech", "mdf"))
        d.behind.append(Box((x + 0.15, d.uniform(-0.02, 0.2), z - half), (0.15, 0.3, half - 3e-4), finish))
        z -= 2.0 * half


def jaw(d: Draft) -> None:
    """A jaw that grips the bottom edge far from the corner."""
    y, half = d.uniform(0.07, 0.12), d.uniform(6e-3, 0.02)
    x = d.uniform(-8e-3, -1e-3)
    steel = Finish("primer", d.uniform(0.1, 0.4), d.uniform(0.0, 0.2))
    d.before.append(Box((0.01, y + half, -0.03 + d.uniform(0.002, 0.012)), (0.01 - x, half, 0.03), steel))


def hinge_rail(d: Draft) -> None:
    """A profile behind the hinge edge and along it, with a narrow gap."""
    x, gap, wide = d.place.thickness + d.uniform(-0.03, 0.04), d.uniform(1e-3, 8e-3), d.uniform(4e-3, 0.02)
    finish = Finish("lacquer", d.uniform(0.2, 0.8), d.uniform(0.0, 0.2))
    d.behind.append(Box((x + 0.01, -gap - wide, 0.5), (0.01, wide, 1.0), finish, d.uniform(-0.5, 0.5) * DEG))


def bottom_rail(d: Draft) -> None:
    """A rail below the door and along its bottom edge."""
    x, gap, high = d.uniform(2e-3, 0.05), d.uniform(1e-3, 8e-3), d.uniform(3e-3, 0.02)
    finish = Finish("lacquer", d.uniform(0.2, 0.8), d.uniform(0.0, 0.2))
    d.behind.append(Box((x + 0.02, 0.0, -gap - high), (0.02, 0.8, high), finish, d.uniform(-0.5, 0.5) * DEG))


def profiles(d: Draft) -> None:
    """A machine's frame: upright and level profiles with slots."""
    for _ in range(3):
        x, wide = d.uniform(0.1, 0.4), d.uniform(0.01, 0.022)
        steel, slot = Finish("lacquer", d.uniform(0.15, 0.6), 0.1), Finish("lacquer", 0.05)
        if d.chance(0.5):
            y = d.uniform(-0.12, 0.02)
            d.behind.append(Box((x, y, 0.0), (wide, wide, 1.0), steel))
            d.behind.append(Box((x - wide - 1e-4, y, 0.0), (1e-4, 4e-3, 1.0), slot))
        else:
            z = d.uniform(-0.1, 0.0)
            d.behind.append(Box((x, 0.0, z), (wide, 1.0, wide), steel))
            d.behind.append(Box((x - wide - 1e-4, 0.0, z), (1e-4, 1.0, 4e-3), slot))


def cable(d: Draft) -> None:
    """Cables that hang behind."""
    for _ in range(int(d.rng.integers(1, 4))):
        x, y = d.place.thickness + d.uniform(0.01, 0.3), d.uniform(-0.08, 0.0)
        lean = d.uniform(-0.04, 0.04)
        shape = Rod((x, y - lean, -0.5), (x + d.uniform(-0.02, 0.02), y + lean, 0.5), d.uniform(2e-3, 6e-3))
        d.behind.append(Bar(shape, d.one_of(0.03, 0.2, 0.6), d.uniform(0.0, 0.3)))
        d.shades.append(shape)


def hair(d: Draft) -> None:
    """A fibre that hangs across an edge."""
    y, z, turn, half = (
        d.uniform(-2e-3, 0.1),
        d.uniform(-2e-3, 0.06),
        d.uniform(0, math.pi),
        d.uniform(5e-3, 0.03),
    )
    if d.chance(0.5):
        y = d.uniform(-2e-3, 2e-3)
    else:
        z = d.uniform(-2e-3, 2e-3)
    x, c, s = d.uniform(-6e-3, -4e-4), half * math.cos(turn), half * math.sin(turn)
    thread = Rod((x, y - c, z - s), (x, y + c, z + s), d.uniform(3e-5, 2e-4))
    d.before.append(Bar(thread, d.one_of(0.03, 0.5, 0.85), 0.0, True))
    d.shades.append(thread)


def mirror(d: Draft) -> None:
    """A bright metal sheet behind the door, which shows its rear."""
    x = d.place.thickness + d.uniform(3e-3, 0.06)
    d.hang(kind="mirror", x=x, albedo=d.uniform(0.2, 0.8), thickness=d.place.thickness, floor=None)


def shiny_bench(d: Draft) -> None:
    """A bright bench below the door, nearly a mirror."""
    z = d.uniform(-0.02, -0.004)
    d.behind.append(
        Box((0.25, 0.0, z - 0.01), (0.25 + d.uniform(-0.02, 0.0), 1.0, 0.01), Finish("lacquer", 0.5, 0.8))
    )


def low_contrast(d: Draft) -> None:
    """A background nearly as light as the face."""
    d.hang(kind=d.one_of("paint", "curtain", "concrete"), albedo=d.finish.albedo * d.uniform(0.75, 1.3))


def bright_hall(d: Draft) -> None:
    """A deep workshop with windows and lamps out of focus."""
    d.hang(
        kind="hall", x=d.uniform(1.0, 3.0), texel=4e-3, albedo=d.uniform(0.05, 0.4), glow=d.uniform(0.5, 3.0)
    )


def floor(d: Draft) -> None:
    """A wall and the floor before it."""
    d.hang(
        kind="concrete",
        x=d.uniform(0.6, 1.5),
        floor=-d.uniform(0.1, 0.4),
        texel=1e-3,
        albedo=d.uniform(0.05, 0.4),
    )


def rubber_seal(d: Draft) -> None:
    """A seal of rubber that stands out of the side behind an edge."""
    x, out = d.uniform(4e-3, 0.02), d.uniform(2e-3, 7e-3)
    rubber = Finish("primer", d.one_of(0.04, 0.2, 0.6), d.uniform(0.0, 0.2))
    if d.chance(0.6):
        d.behind.append(Box((x + 2e-3, 2e-3 - out / 2.0, 1.0), (2e-3, out / 2.0 + 2e-3, 1.0), rubber))
    else:
        d.behind.append(Box((x + 2e-3, 1.0, 2e-3 - out / 2.0), (2e-3, 1.0, out / 2.0 + 2e-3), rubber))


def cable_before(d: Draft) -> None:
    """A hose or cable that hangs before the door, out of focus, perhaps over an edge."""
    x, y, lean = d.uniform(-0.06, -0.01), d.uniform(-0.03, 0.09), d.uniform(-0.3, 0.3)
    shape = Rod((x, y - lean * 0.3, -0.3), (x, y + lean * 0.3, 0.3), d.uniform(1e-3, 4e-3))
    d.before.append(Bar(shape, d.one_of(0.03, 0.3, 0.7), d.uniform(0.0, 0.2)))
    d.shades.append(shape)


def tiles(d: Draft) -> None:
    """A tiled wall, of which the joints run along the edges of the door."""
    d.hang(
        kind="tiles",
        x=d.place.thickness + d.uniform(5e-3, 0.3),
        albedo=d.uniform(0.1, 0.7),
        texel=3e-4,
        floor=None,
    )
