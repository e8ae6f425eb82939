"""Pictures with one of the empty clamp each: what belongs to the clamp is in both, the door and what came since is not.

Both have their own noise, and may have their own light and camera.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp
from doormill_ros.simulation.picture.optics import expose
from doormill_ros.simulation.picture.picture import exposure
from doormill_ros.simulation.picture.scene import Blot, PictureScene, SceneCamera, Surface
from doormill_ros.units import DEG, MM
from support.pictures import clutter
from support.pictures.conditions import pictures
from support.pictures.corpus import workshop_scene

_NOISE = 77  # beside a picture's own seed, that of the noise in the picture of the empty clamp
_LIGHT = 0.3  # share by which the light may differ
_MOVED = 0.2 * MM
SCREWED = (4, 24)  #: corners of rails, fingers and screw heads in `clutter`; dust has another number

#: A scene, and what of it is the empty clamp.
Pair = tuple[PictureScene, PictureScene]


@dataclass(frozen=True, eq=False)
class ClampPicture:
    """One picture and that of its empty clamp.

    Attributes:
        scene: The scene with its true pose.
        empty: The same cell without the door.
        seed: Of the random fields, which both share.
        stands: Whether a door stands there.
        fair: Whether a person sees its edges plainly.
    """

    scene: PictureScene
    empty: PictureScene
    seed: int
    stands: bool = True
    fair: bool = True

    def camera(self) -> CameraModel:
        """The cell's camera with the picture of the empty clamp."""
        camera = load_camera()
        picture = render_empty(self.empty, self.seed)
        clamp = EmptyClamp(self.scene.width, picture, camera.k, camera.distortion)
        return replace(camera, empty=(clamp,))


def render_empty(scene: PictureScene, seed: int) -> np.ndarray:
    """The picture (h, w), uint8, of an empty clamp: fields as `render_picture` draws them by a seed, not the noise."""
    return expose(
        exposure(scene, np.random.default_rng(seed)), scene.sensor, np.random.default_rng((seed, _NOISE))
    )


def emptied(scene: PictureScene, *kept: Blot) -> PictureScene:
    """The clamp without the door, with that of what lies about which belongs to the clamp."""
    return replace(scene, door=False, back_edge=None, blots=kept, light=replace(scene.light, shadows=()))


def _of(name: str) -> Callable[[np.random.Generator, int, int], Pair]:
    """A condition of the other corpus; its blots belong to the clamp."""

    def pair(rng: np.random.Generator, number: int, seed: int) -> Pair:
        *_, item = pictures(name, number + 1, seed)
        return item.scene, emptied(item.scene, *item.scene.blots)

    return pair


def _workshop(rng: np.random.Generator, number: int, seed: int) -> Pair:
    scene = workshop_scene(rng, SceneCamera.load(), load_layout())
    screwed = [blot for blot in scene.blots if len(blot.outline) in SCREWED]
    return scene, emptied(scene, *screwed)


def _plate(texture: float) -> Callable[[np.random.Generator, int, int], Pair]:
    """No door, but a corner of another surface in the plane of its face: a door drawn once more as the clamp's own."""

    def pair(rng: np.random.Generator, number: int, seed: int) -> Pair:
        *_, item = pictures("plain", number + 1, seed)
        face = Surface(rng.uniform(0.4, 0.8), mottle=texture, mottle_size=2 * MM)
        scene = replace(item.scene, face=face)
        return scene, scene

    return pair


def _square_behind(rng: np.random.Generator, number: int, seed: int) -> Pair:
    """A plate of the clamp behind the door, square to it, that ends up to 12 mm outside of its edges."""
    *_, item = pictures("plain", number + 1, seed)
    out, turn = rng.uniform(0.5, 12.0, 2) * MM, rng.choice([0.0, 1.0]) * rng.normal(0.0, 0.3) * DEG
    corners = np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.3], [0.0, 0.3]])
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    grey = item.scene.face.brightness * rng.uniform(0.6, 1.1)
    plate = Blot(corners @ rotation.T - out, float(grey), behind=True)
    scene = replace(item.scene, blots=(plate,))
    return scene, emptied(scene, plate)


def _dusty(rng: np.random.Generator, number: int, seed: int) -> Pair:
    *_, item = pictures("plain", number + 1, seed)
    return replace(item.scene, blots=tuple(clutter.dust(rng, 60))), emptied(item.scene)


def _other_light(rng: np.random.Generator, number: int, seed: int) -> Pair:
    *_, item = pictures("plain", number + 1, seed)
    light = replace(
        item.scene.light,
        level=1.0 + rng.uniform(-_LIGHT, _LIGHT),
        gradient=tuple(rng.uniform(-0.25, 0.25, 2)),
    )
    return item.scene, replace(emptied(item.scene), light=light)


def _moved(
    pair: Callable[[np.random.Generator, int, int], Pair],
) -> Callable[[np.random.Generator, int, int], Pair]:
    def moved(rng: np.random.Generator, number: int, seed: int) -> Pair:
        scene, empty = pair(rng, number, seed)
        way = rng.uniform(0.0, 2.0 * np.pi)
        shift = _MOVED * np.array([0.0, np.cos(way), np.sin(way)])
        return scene, replace(empty, camera=replace(empty.camera, origin=empty.camera.origin + shift))

    return moved


def _soft(rng: np.random.Generator, number: int, seed: int) -> Pair:
    *_, item = pictures("plain", number + 1, seed)
    sensor = replace(item.scene.sensor, defocus=rng.uniform(1.0, 2.5))
    return replace(item.scene, sensor=sensor), emptied(item.scene)


@dataclass(frozen=True)
class _Kind:
    pair: Callable[[np.random.Generator, int, int], Pair]
    stands: bool = True
    fair: bool = True


_TEXTURED = _plate(0.02)
CLAMPS: dict[str, _Kind] = {
    "no door, a plate behind": _Kind(_of("no door, a plate behind"), stands=False, fair=False),
    "no door, a plate with texture": _Kind(_TEXTURED, stands=False, fair=False),
    "the same, camera moved by 0.2 mm": _Kind(_moved(_TEXTURED), stands=False, fair=False),
    "jaw along the edge": _Kind(_of("jaw along the edge"), fair=False),
    "jaw as dark as the background": _Kind(_of("jaw as dark as the background"), fair=False),
    "the same jaw, camera moved by 0.2 mm": _Kind(_moved(_of("jaw as dark as the background")), fair=False),
    "square plate of the clamp behind": _Kind(
        _square_behind, fair=False
    ),  # it frames the door as a lipping would
    "second door behind": _Kind(lambda rng, number, seed: _second(number, seed)),
    "workshop": _Kind(_workshop),
    "clean": _Kind(_of("plain")),
    "dusty": _Kind(_dusty),
    "shadow": _Kind(_of("sharp shadow 2 mm inside")),
    "out of focus": _Kind(_soft),
    "other light": _Kind(_other_light),
    "camera moved by 0.2 mm": _Kind(_moved(_workshop)),
}


def _second(number: int, seed: int) -> Pair:
    *_, item = pictures("second door behind", number + 1, seed)
    return item.scene, emptied(item.scene)


def clamp_pictures(name: str, count: int, seed: int) -> Iterator[ClampPicture]:
    """Pictures of one kind, equal for equal seeds."""
    kind = CLAMPS[name]
    for number in range(count):
        rng = np.random.default_rng((seed, number, *name.encode()))
        scene, empty = kind.pair(rng, number, seed)
        yield ClampPicture(scene, empty, int(rng.integers(2**31)), kind.stands, kind.fair)
