"""Features that belong to the door: how it is made, what was cut, drawn, stuck and torn."""

from __future__ import annotations

from dataclasses import replace

from support.views.draft import Draft
from support.views.finish import Finish
from support.views.marks_edge import Arris, Chips, Drop, Dust, Overhang, Tape, TearOut
from support.views.marks_face import BOTTOM, HINGE, Groove, Line, Lipping, Pane, Ripple, Sheet
from support.views.solids import Box


def lipping(d: Draft) -> None:
    d.marks.append(
        Lipping(
            d.uniform(4e-3, 12e-3),
            d.some_finish(kinds=("oak", "beech", "walnut", "pine")),
            None,
            d.chance(0.5),
        )
    )


def edge_band(d: Draft) -> None:
    band = d.some_finish(d.finish.albedo * d.uniform(0.7, 1.3), ("lacquer", "print"))
    d.marks.append(Lipping(d.uniform(4e-4, 2.2e-3), band, d.one_of(0.04, 0.1, 0.7), d.chance(0.7)))


def round_arris(d: Draft) -> None:
    d.marks.append(Arris(d.uniform(1e-4, 4e-4), True, d.uniform(0.6, 1.5), 1.0))


def bright_arris(d: Draft) -> None:
    d.marks.append(Arris(d.uniform(1.5e-4, 4e-4), d.chance(0.5), d.uniform(0.3, 1.0), d.uniform(1.2, 1.8)))


def burnt_arris(d: Draft) -> None:
    d.marks.append(Arris(d.uniform(1e-4, 4e-4), d.chance(0.3), d.uniform(0.3, 1.0), d.uniform(0.2, 0.7)))


def v_groove(d: Draft) -> None:
    edge = d.one_of(HINGE, BOTTOM)
    d.marks.append(Groove(edge, d.uniform(3e-3, 20e-3), d.uniform(5e-4, 2e-3), d.uniform(0.5, 1.2), "v"))


def moulding(d: Draft) -> None:
    for edge in (HINGE, BOTTOM) if d.chance(0.5) else (d.one_of(HINGE, BOTTOM),):
        d.marks.append(
            Groove(edge, d.uniform(8e-3, 22e-3), d.uniform(2e-3, 6e-3), d.uniform(0.3, 0.9), "ogee")
        )


def intumescent_strip(d: Draft) -> None:
    d.marks.append(
        Groove(HINGE, d.uniform(5e-3, 15e-3), d.uniform(2e-3, 5e-3), 0.0, "slot", d.one_of(0.05, 0.35, 0.75))
    )


def drip_groove(d: Draft) -> None:
    d.marks.append(
        Groove(BOTTOM, d.uniform(6e-3, 18e-3), d.uniform(1.5e-3, 3e-3), d.uniform(0.8, 1.4), "round")
    )


def open_slot(d: Draft) -> None:
    d.marks.append(
        Groove(d.one_of(HINGE, BOTTOM), d.uniform(4e-3, 14e-3), d.uniform(1e-3, 3e-3), 0.0, "slot")
    )


def overhang(d: Draft) -> None:
    first = d.uniform(0.0, 0.05)
    d.marks.append(
        Overhang(d.one_of(HINGE, BOTTOM), first, first + d.uniform(0.01, 0.06), d.uniform(1e-4, 4e-4))
    )


def tear_out(d: Draft) -> None:
    first = d.uniform(0.0, 0.06)
    edge = d.one_of(HINGE, BOTTOM)
    d.marks.append(
        TearOut(edge, first, first + d.uniform(0.01, 0.05), d.uniform(5e-4, 2e-3), d.uniform(1.1, 1.5))
    )


def pencil_line(d: Draft) -> None:
    edge, turn = d.one_of(HINGE, BOTTOM), d.uniform(-0.01, 0.01)
    d.marks.append(
        Line(edge, d.uniform(3e-3, 15e-3), d.uniform(1e-4, 2.5e-4), d.uniform(0.2, 0.6), 1.0, turn)
    )


def laser_line(d: Draft) -> None:
    for edge in (HINGE, BOTTOM) if d.chance(0.4) else (d.one_of(HINGE, BOTTOM),):
        d.marks.append(Line(edge, d.uniform(3e-3, 15e-3), d.uniform(6e-5, 2e-4), d.uniform(0.5, 0.95)))


def tape(d: Draft) -> None:
    first = d.uniform(0.0, 0.07)
    edge, length = d.one_of(HINGE, BOTTOM), d.uniform(0.012, 0.05)
    colour, turn = d.one_of(0.25, 0.55, 0.8), d.uniform(-0.1, 0.1)
    d.marks.append(
        Tape(edge, first, first + length, d.uniform(5e-3, 2e-2), d.uniform(5e-4, 8e-3), colour, turn)
    )


def film(d: Draft) -> None:
    at, up = d.uniform(2e-3, 15e-3), d.uniform(2e-3, 15e-3)
    half = 0.6
    turn, tone, gloss = d.uniform(-0.004, 0.004), d.one_of(0.75, 0.85, 1.15), d.uniform(0.02, 0.15)
    blue = d.chance(0.3)
    d.marks.append(
        Sheet((at + half, up + half), (half, half), turn, 0.3 if blue else None, tone, gloss, 5e-5)
    )


def chips(d: Draft) -> None:
    pieces = [
        (d.one_of(HINGE, BOTTOM), d.uniform(0.0, 0.11), d.uniform(2e-4, 1.5e-3), d.uniform(3e-4, 3e-3))
        for _ in range(int(d.rng.integers(1, 6)))
    ]
    d.marks.append(Chips(tuple(pieces), d.uniform(0, 1000), d.uniform(0.5, 0.8)))


def sawdust(d: Draft) -> None:
    first = d.uniform(-0.01, 0.08)
    flakes = tuple(
        (
            d.uniform(-0.01, 0.13),
            d.uniform(-0.02, 0.004),
            d.uniform(5e-4, 3e-3),
            d.uniform(1e-4, 8e-4),
            d.uniform(0, 3.1),
        )
        for _ in range(int(d.rng.integers(5, 25)))
    )
    length, high = d.uniform(0.02, 0.06), d.uniform(5e-4, 4e-3)
    d.marks.append(Dust(first, first + length, high, flakes, d.uniform(0.45, 0.7), d.uniform(0, 1000)))


def glue_drop(d: Draft) -> None:
    d.marks.append(
        Drop(d.one_of(HINGE, BOTTOM), d.uniform(0.003, 0.09), d.uniform(8e-4, 4e-3), d.uniform(0.25, 0.8))
    )


def label(d: Draft) -> None:
    half = (d.uniform(0.01, 0.03), d.uniform(0.008, 0.02))
    at = (half[0] + d.uniform(1e-3, 0.05), half[1] + d.uniform(1e-3, 0.03))
    d.marks.append(Sheet(at, half, d.uniform(-0.05, 0.05), d.uniform(0.75, 0.9), printed=True))


def glass_bead(d: Draft) -> None:
    at = d.uniform(0.015, 0.06)
    d.marks.append(Pane(at, d.uniform(6e-3, 12e-3), d.uniform(0.015, 0.05), d.uniform(0.05, 0.3)))


def planer_ripple(d: Draft) -> None:
    d.marks.append(Ripple(d.uniform(1.2e-3, 4e-3), d.uniform(0.01, 0.06)))


def rebate(d: Draft) -> None:
    step, lip = d.uniform(0.012, 0.026), d.uniform(0.010, 0.015)
    d.step = step
    half = ((d.place.thickness - step) / 2.0, lip / 2.0 + 2e-3, 1.0)
    below = 1.0 if d.chance(0.6) else 1.0 + d.uniform(0.0, 0.01)
    d.behind.append(Box((step + half[0], -lip / 2.0 + 2e-3, below), half, d.finish))


def veneer_joint(d: Draft) -> None:
    d.finish = replace(d.some_finish(kinds=("veneer",)), leaf=d.uniform(0.006, 0.03))


def dark_door(d: Draft) -> None:
    d.finish = replace(d.some_finish(d.uniform(0.05, 0.12)), gloss=d.uniform(0.0, 0.03))
    d.hang(albedo=d.uniform(0.35, 0.75), kind=d.one_of("paint", "concrete", "curtain"))
    d.take(level=d.uniform(0.07, 0.2))


def glossy(d: Draft) -> None:
    d.finish = Finish(
        "lacquer", d.uniform(0.2, 0.7), d.uniform(0.3, 0.8), (d.uniform(0, 1000), d.uniform(0, 1000))
    )


def kick_plate(d: Draft) -> None:
    """A metal plate on the lower part of the face, a little inside its edges."""
    at, up, high = d.uniform(2e-3, 0.012), d.uniform(2e-3, 0.012), d.uniform(0.015, 0.06)
    turn, tone, gloss = d.uniform(-0.006, 0.006), d.uniform(0.25, 0.8), d.uniform(0.1, 0.7)
    d.marks.append(Sheet((at + 0.5, up + high), (0.5, high), turn, tone, gloss=gloss))


def bare_margin(d: Draft) -> None:
    """Paint that ends a little inside the edges, where a mask lay."""
    at, up = d.uniform(1e-3, 8e-3), d.uniform(1e-3, 8e-3)
    tone = float(d.finish.albedo * d.one_of(0.4, 0.7, 1.3))
    d.marks.append(
        Sheet((at + 0.6, up + 0.6), (0.6, 0.6), d.uniform(-0.002, 0.002), min(tone, 0.9), ragged=1e-4)
    )
