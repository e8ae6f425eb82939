"""Pictures of doors with one of the empty clamp that was taken before something changed, or after which nothing did.

All have a mottled background that may hardly show, a half of them rail, finger and screw of the clamp as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import rotation_from_vector
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera, Shadow
from doormill_ros.units import DEG, MM
from support.pictures import clutter
from support.pictures.corpus import workshop_scene
from support.pictures.empty_clamps import SCREWED, ClampPicture, Pair, emptied

#: What happened since the picture of the empty clamp: of the scene as it is and the clamp as it is, what it was.
Since = Callable[[PictureScene, PictureScene, np.random.Generator], Pair]

MOVES = (0.1, 0.2, 0.5, 1.0)  #: ways of the camera [mm]
TURNS = (0.05, 0.5)  #: its turns, from and to [degrees]
LENS = (0.01, 0.03)  #: change of its focal length, as a share of it
LAMPS = (0.3, 0.45)  #: light then, as a share of what it is now
AGED = 0.7  #: light of an old lamp, as a share of what it was


def clamp_scene(rng: np.random.Generator, furnished: bool) -> Pair:
    """A door in a workshop, and its empty clamp; furnished: with rail, finger and screw."""
    scene = workshop_scene(rng, SceneCamera.load(), load_layout())
    own = [blot for blot in scene.blots if len(blot.outline) in SCREWED]
    if furnished:
        dust = [blot for blot in scene.blots if len(blot.outline) not in SCREWED]
        own = clutter.beam(rng) + clutter.screw(rng) + clutter.clamp(rng)
        scene = replace(scene, blots=tuple(own[:1] + dust + own[1:]))
    return scene, emptied(scene, *own)


def _nothing(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    return scene, empty


def _dust(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    return replace(scene, blots=(*scene.blots, *clutter.dust(rng, 150))), empty


def _noise(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    sensor = replace(scene.sensor, read_noise=rng.uniform(3.0, 5.0), gain=0.1)
    return replace(scene, sensor=sensor), empty


def _aged(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    level = scene.light.level * rng.uniform(AGED, 1.0)
    gradient = tuple(np.array(scene.light.gradient) + rng.uniform(-0.05, 0.05, 2))
    return replace(scene, light=replace(scene.light, level=level, gradient=gradient)), empty


def _door_shadow(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    """What the door throws on what is behind it: a border along one of its edges, up to 30 mm outside of it."""
    away, factor = rng.uniform(1.0, 30.0) * MM, rng.uniform(0.3, 0.8)
    place, angle = ((-away, 0.0), 0.0) if rng.random() < 0.5 else ((0.0, -away), np.pi / 2)
    thrown = Shadow(place, angle, rng.uniform(0.5, 10.0) * MM, factor, on_face=False)
    return replace(scene, light=replace(scene.light, shadows=(*scene.light.shadows, thrown))), empty


def _soft(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    return replace(scene, sensor=replace(scene.sensor, defocus=rng.uniform(1.0, 2.5))), empty


def _moved(way: float) -> Since:
    def moved(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        shift = way * MM * np.array([0.0, np.cos(angle), np.sin(angle)])
        return scene, replace(empty, camera=replace(empty.camera, origin=empty.camera.origin + shift))

    return moved


def _turned(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    axis = rng.standard_normal(3)
    turn = rotation_from_vector(rng.uniform(*TURNS) * DEG * axis / np.linalg.norm(axis))
    return scene, replace(empty, camera=replace(empty.camera, turn=turn))


def _lens(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    matrix = empty.camera.matrix.copy()
    matrix[[0, 1], [0, 1]] *= 1.0 + float(rng.choice([-1.0, 1.0])) * rng.uniform(*LENS)
    return scene, replace(empty, camera=replace(empty.camera, matrix=matrix))


def _lamp(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    level, gradient = empty.light.level * rng.uniform(*LAMPS), tuple(rng.uniform(-0.25, 0.25, 2))
    return scene, replace(empty, light=replace(empty.light, level=level, gradient=gradient))


def _jaws(scene: PictureScene, empty: PictureScene, rng: np.random.Generator) -> Pair:
    before = clutter.beam(rng) + clutter.screw(rng) + clutter.clamp(rng)
    return scene, replace(empty, blots=tuple(before))


@dataclass(frozen=True)
class _Kind:
    since: Since
    stale: bool = True
    furnished: bool = False


SINCE: dict[str, _Kind] = {
    "nothing": _Kind(_nothing, stale=False),
    "sawdust": _Kind(_dust, stale=False),
    "more noise": _Kind(_noise, stale=False),
    "the lamp has aged": _Kind(_aged, stale=False),
    "a shadow of the door": _Kind(_door_shadow, stale=False),
    "out of focus": _Kind(_soft, stale=False),
    **{f"camera moved by {way:g} mm": _Kind(_moved(way)) for way in MOVES},
    "camera turned": _Kind(_turned),
    "another lens": _Kind(_lens),
    "another lamp": _Kind(_lamp),
    "other jaws": _Kind(_jaws, furnished=True),
}


def stale_pictures(name: str, count: int, seed: int) -> Iterator[ClampPicture]:
    """Pictures before which one thing happened, equal for equal seeds; every second one furnished."""
    kind = SINCE[name]
    for number in range(count):
        rng = np.random.default_rng((seed, number, *name.encode()))
        scene, empty = kind.since(*clamp_scene(rng, kind.furnished or number % 2 == 1), rng)
        yield ClampPicture(scene, empty, int(rng.integers(2**31)))
