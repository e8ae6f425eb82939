"""Pictures with two or more conditions at once, from those of `conditions` that leave both edges plain; seeded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera
from support.pictures.conditions import CONDITIONS, ConditionPicture, plain_scene

PAIRED = (
    "sharp shadow 2 mm inside",
    "hardwood lipping",
    "edge band 2 mm",
    "edge band 0.4 to 1 mm",
    "faint strip of 5 %",
    "groove beside the edge",
    "label in the corner",
    "second door behind",
    "bright arris",
    "saw dust on the bottom edge",
    "corner broken off",
    "oak grain",
    "grain along the bottom edge",
    "bevel",
    "rail behind, along the edge",
    "tape across an edge",
    "glossy streak along the edge",
    "white door before a white wall",
    "out of square by 0.1 degrees",
)
_ADDED = ("strips", "blots")  #: of which both conditions have their own


def is_unseen(one: str, other: str) -> bool:
    """Whether a picture with both conditions does not show which step is the edge.

    A bevel nearly as bright as the face, beside something that hides where it ends; and a wall as bright as the door,
    before which a shadow's border is the only step.
    """
    pair = {one, other}
    return "bevel" in pair or pair == {"white door before a white wall", "sharp shadow 2 mm inside"}


def picture_of(number: int, seed: int, count: int = 2) -> tuple[tuple[str, ...], ConditionPicture]:
    """Some conditions and a picture with all of them, equal for equal numbers and seeds."""
    rng = np.random.default_rng((seed, number))
    names = tuple(str(name) for name in rng.choice(PAIRED, count, replace=False))
    scene = plain = plain_scene(rng, SceneCamera.load(), load_layout())
    for name in names:
        scene = replace(scene, **_changed(plain, scene, CONDITIONS[name].change(plain, rng)))
    seen_as = ", ".join(names)
    return names, ConditionPicture(
        seen_as, True, False, False, None, scene, scene.thickness, int(rng.integers(2**31))
    )


def pairs(count: int, seed: int) -> Iterator[tuple[tuple[str, ...], ConditionPicture]]:
    """The first pairs of a seed."""
    for number in range(count):
        yield picture_of(number, seed)


def _changed(plain: PictureScene, first: PictureScene, second: PictureScene) -> dict[str, Any]:
    """What the second scene changes of the plain one, what it adds put to what the first has."""
    changed = {}
    for field in fields(plain):
        value = getattr(second, field.name)
        if value is not getattr(plain, field.name):
            changed[field.name] = getattr(first, field.name) + value if field.name in _ADDED else value
    return changed
