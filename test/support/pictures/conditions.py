"""Pictures with one condition each that the door, the cell or the camera may bring; seeded, with the truth.

`fair` conditions leave both edges plain to a person who looks; in the others a refusal is right. Whatever is accepted
has to be true.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.cell.places.layout import CellLayout, DoorOffset, load_layout
from doormill_ros.localization.settings import LocalizerSettings, shipped_settings
from doormill_ros.simulation.picture.scene import (
    BackEdge,
    Blot,
    Chip,
    Edges,
    Light,
    PictureScene,
    SceneCamera,
    Sensor,
    Shadow,
    Strip,
    Surface,
)
from doormill_ros.units import DEG, MM
from support.pictures.marked_cell import marked_cameras

EDGES = ("hinge", "bottom")
_BOW = 0.3 * MM
_VISIBLE = 0.03  # difference of brightness that a person sees
Change = Callable[[PictureScene, np.random.Generator], PictureScene]


@dataclass(frozen=True, eq=False)
class ConditionPicture:
    """One picture: render it with `render_picture(scene, seed)`.

    Attributes:
        condition: Its name.
        fair: Whether a person sees both edges plainly.
        marked: Whether the cell has marks; without them nothing in a picture tells that the camera was knocked.
        beams: Whether six beams look at the door beside the camera; by itself no picture tells a thicker door.
        bow: What the cell says of how much its doors are bowed, standard deviation [m]; None for what is shipped.
        scene: The scene with its true pose.
        thickness: What the recipe says of the door's thickness [m].
        seed: Of its random fields.
    """

    condition: str
    fair: bool
    marked: bool
    beams: bool
    bow: float | None
    scene: PictureScene
    thickness: float
    seed: int

    @property
    def settings(self) -> LocalizerSettings:
        """Those of the cell."""
        shipped = shipped_settings()
        return shipped if self.bow is None else replace(shipped, straightness_deviation=self.bow)


@dataclass(frozen=True)
class _Condition:
    change: Change
    fair: bool = True
    marked: bool = False
    beams: bool = False
    bow: float | None = None


CONDITIONS: dict[str, _Condition] = {}


def _condition(
    name: str, fair: bool = True, marked: bool = False, beams: bool = False, bow: float | None = None
) -> Callable[[Change], Change]:
    def keep(change: Change) -> Change:
        CONDITIONS[name] = _Condition(change, fair, marked, beams, bow)
        return change

    return keep


def plain_scene(rng: np.random.Generator, camera: SceneCamera, layout: CellLayout) -> PictureScene:
    """A door in good light: little texture, clear step, in focus."""
    limits = layout.limits
    offset = DoorOffset(*(rng.uniform(-0.9, 0.9, 3) * [limits.y, limits.z, limits.rotation]))
    return PictureScene(
        width=rng.uniform(0.4, 1.2),
        thickness=rng.uniform(0.035, 0.070),
        offset=offset,
        face=Surface(rng.uniform(0.5, 0.7), mottle=0.015, grain=rng.uniform(0.0, 0.03)),
        background=Surface(rng.uniform(0.12, 0.25), mottle=0.03, mottle_size=4 * MM),
        edges=Edges(roughness=0.015 * MM, squareness=rng.normal(0.0, 5e-5)),
        light=Light(level=1.0, gradient=tuple(rng.uniform(-0.1, 0.1, 2)), vignetting=0.1),
        sensor=Sensor(blur=rng.uniform(0.8, 1.2)),
        camera=camera,
        layout=layout,
    )


def _edge(rng: np.random.Generator) -> str:
    return str(rng.choice(EDGES))


def _shade(rng: np.random.Generator, least: float, most: float) -> float:
    """A factor on the brightness that is darker or lighter by the given share."""
    return float(1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(least, most))


def _strips(*names: str, start: float, stop: float, factor: float, blur: float = 5e-5) -> tuple[Strip, ...]:
    return tuple(Strip(name, start, stop, factor, blur) for name in names)


def _which(rng: np.random.Generator) -> tuple[str, ...]:
    return EDGES if rng.random() < 0.5 else (_edge(rng),)


@_condition("plain")
def plain(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return scene


@_condition("marks beside the door", marked=True)
def marks(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return scene


@_condition("beams beside the camera", beams=True)
def beams(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return scene


@_condition("sharp shadow 2 mm inside")
def shadow(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    inside, factor = rng.uniform(1.0, 4.0) * MM, rng.uniform(0.3, 0.6)
    place, angle = ((inside, 0.0), np.pi) if rng.random() < 0.5 else ((0.0, inside), -np.pi / 2)
    dark = Shadow(place, angle, rng.uniform(0.1, 0.5) * MM, factor)
    return replace(scene, light=replace(scene.light, shadows=(dark,)))


@_condition("hardwood lipping")
def lipping(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide, factor = float(rng.choice([5.0, 6.0, 8.0, 10.0])) * MM, _shade(rng, 0.04, 0.2)
    return replace(scene, strips=_strips(*_which(rng), start=-1.0, stop=wide, factor=factor))


@_condition("edge band 2 mm")
def band(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide, factor = rng.uniform(1.0, 3.0) * MM, _shade(rng, 0.08, 0.5)
    return replace(scene, strips=_strips(*_which(rng), start=-1.0, stop=wide, factor=factor))


@_condition("edge band 0.4 to 1 mm")
def narrow_band(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide, factor = rng.uniform(0.4, 1.0) * MM, _shade(rng, 0.08, 0.5)
    return replace(scene, strips=_strips(*EDGES, start=-1.0, stop=wide, factor=factor))


@_condition("faint strip of 5 %")
def faint_strip(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide = rng.uniform(2.0, 8.0) * MM
    return replace(scene, strips=_strips(*EDGES, start=-1.0, stop=wide, factor=0.95))


@_condition("groove beside the edge")
def groove(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    start, wide = rng.uniform(2.0, 12.0) * MM, rng.uniform(1.0, 4.0) * MM
    return replace(
        scene, strips=_strips(*_which(rng), start=start, stop=start + wide, factor=rng.uniform(0.3, 0.8))
    )


def _jaw(scene: PictureScene, rng: np.random.Generator, grey: float) -> PictureScene:
    edge, inside = _edge(rng), rng.uniform(2.0, 13.0) * MM
    corners = np.array([[-0.1, -0.02], [inside, -0.02], [inside, 0.3], [-0.1, 0.3]])
    return replace(scene, blots=(Blot(corners if edge == "hinge" else corners[:, ::-1], grey),))


@_condition("jaw along the edge", fair=False)
def jaw(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    back = scene.background.brightness
    grey = scene.face.brightness * rng.choice([0.3, 0.6, 1.3])
    return _jaw(scene, rng, float(grey if abs(grey - back) > _VISIBLE else back - _VISIBLE))


@_condition("jaw as dark as the background", fair=False)
def hidden_jaw(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return _jaw(scene, rng, scene.background.brightness)


@_condition("label in the corner")
def label(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    place = rng.uniform(3.0, 8.0, 2) * MM
    wide, high = rng.uniform(30.0, 60.0) * MM, rng.uniform(10.0, 25.0) * MM
    box = np.array([[0, 0], [wide, 0], [wide, high], [0, high]])
    blots = [Blot(box + place, 0.9)]
    at = 2.0 * MM
    while at < wide - 3.0 * MM:
        bar = rng.uniform(0.3, 1.2) * MM
        line = np.array([[at, 2 * MM], [at + bar, 2 * MM], [at + bar, high - 4 * MM], [at, high - 4 * MM]])
        blots.append(Blot(line + place, 0.05))
        at += bar + rng.uniform(0.3, 1.2) * MM
    return replace(scene, blots=tuple(blots))


@_condition("second door behind")
def second_door(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    out = rng.uniform(2.0, 12.0, 2) * MM
    behind = BackEdge(float(out[0]), float(out[1]), rng.uniform(0.045, 0.12), rng.uniform(0.75, 0.95))
    return replace(scene, back_edge=behind)


@_condition("no door, a plate behind", fair=False)
def empty(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    gone = DoorOffset(0.4, 0.4, 0.0)
    near = rng.uniform(-8.0, 8.0, 2) * MM - 0.4
    turn = rng.uniform(-1.0, 1.0) * DEG
    corners = np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.3], [0.0, 0.3]])
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    plate = Blot(corners @ rotation.T + near, rng.uniform(0.4, 0.8), behind=True)
    return replace(scene, offset=gone, blots=(plate,))


@_condition("dark arris")
def dark_arris(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide = rng.uniform(0.1, 0.4) * MM
    return replace(scene, strips=_strips(*EDGES, start=-1.0, stop=wide, factor=rng.uniform(0.3, 0.6)))


@_condition("bright arris")
def bright_arris(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    wide = rng.uniform(0.1, 1.0) * MM
    return replace(scene, strips=_strips(*EDGES, start=-1.0, stop=wide, factor=rng.uniform(1.15, 1.4)))


@_condition("bowed edge", fair=False, bow=_BOW / np.sqrt(3.0))
def bowed(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    bow = tuple(rng.uniform(-_BOW, _BOW, 2))
    return replace(scene, edges=replace(scene.edges, bow=bow, bow_length=0.4))


@_condition("wavy edge")
def wavy(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    rough = rng.uniform(0.02, 0.06) * MM
    return replace(
        scene, edges=replace(scene.edges, roughness=rough, correlation=rng.uniform(10.0, 30.0) * MM)
    )


@_condition("saw dust on the bottom edge")
def heap(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    start = rng.uniform(0.0, 0.05)
    along = np.linspace(start, start + rng.uniform(0.35, 0.5) * 0.13, 40)
    crest = np.convolve(rng.uniform(0.1, 1.5, 40) * MM, np.ones(5) / 5, mode="same")
    outline = np.vstack([np.column_stack([along, crest]), np.column_stack([along[::-1], np.full(40, -0.02)])])
    return replace(scene, blots=(Blot(outline, scene.face.brightness * rng.uniform(0.85, 1.15)),))


@_condition("camera moved", fair=False, marked=True)
def moved(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    shift = np.array([0.0, *(rng.choice([-1.0, 1.0], 2) * rng.uniform(0.2, 0.5, 2))]) * MM
    return replace(scene, camera=replace(scene.camera, origin=scene.camera.origin + shift))


@_condition("focal length off", fair=False, marked=True)
def focal(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    matrix = scene.camera.matrix.copy()
    matrix[0, 0], matrix[1, 1] = matrix[0, 0] * 1.003, matrix[1, 1] * 1.003
    return replace(scene, camera=replace(scene.camera, matrix=matrix))


@_condition("out of square by 0.05 degrees")
def askew_a_little(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return replace(scene, edges=replace(scene.edges, squareness=float(rng.choice([-1, 1])) * 0.05 * DEG))


@_condition("out of square by 0.1 degrees")
def askew(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    return replace(scene, edges=replace(scene.edges, squareness=float(rng.choice([-1, 1])) * 0.1 * DEG))


@_condition("corner broken off")
def broken(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    size = rng.uniform(10.0, 25.0) * MM
    chips = (Chip("hinge", 0.0, 2.0 * size, 0.6 * size), Chip("bottom", 0.0, 2.0 * size, 0.6 * size))
    return replace(scene, edges=replace(scene.edges, chips=chips))


@_condition("oak grain")
def oak(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    face = replace(scene.face, grain=rng.uniform(0.15, 0.25), grain_width=rng.uniform(0.4, 1.2) * MM)
    return replace(scene, face=face, background=Surface(0.1, mottle=0.03, mottle_size=4 * MM))


@_condition("grain along the bottom edge")
def cross_grain(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    face = replace(
        scene.face, grain=rng.uniform(0.08, 0.15), grain_angle=np.pi / 2 + rng.normal(0, 0.5 * DEG)
    )
    return replace(scene, face=face)


@_condition("bevel")
def bevel(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    size = rng.uniform(1.0, 5.0) * MM
    return replace(scene, back_edge=BackEdge(size, size, size, rng.uniform(0.4, 0.8)))


@_condition("rail behind, along the edge")
def rail(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    edge, away = _edge(rng), rng.uniform(1.0, 8.0) * MM
    corners = np.array([[-away - 0.01, -0.05], [-away, -0.05], [-away, 0.3], [-away - 0.01, 0.3]])
    grey = scene.face.brightness * rng.uniform(0.7, 1.2)
    return replace(scene, blots=(Blot(corners if edge == "hinge" else corners[:, ::-1], grey, behind=True),))


@_condition("tape across an edge")
def tape(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    edge, place, wide = _edge(rng), rng.uniform(0.01, 0.04), rng.uniform(10.0, 25.0) * MM
    reach = rng.uniform(5.0, 30.0) * MM
    corners = np.array([[-reach, place], [reach, place], [reach, place + wide], [-reach, place + wide]])
    return replace(
        scene, blots=(Blot(corners if edge == "hinge" else corners[:, ::-1], rng.uniform(0.6, 0.9)),)
    )


@_condition("glossy streak along the edge")
def gloss(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    start = rng.uniform(0.5, 6.0) * MM
    strips = _strips(
        _edge(rng), start=start, stop=start + rng.uniform(1.0, 4.0) * MM, factor=1.4, blur=1.0 * MM
    )
    return replace(scene, strips=strips)


@_condition("white door before a white wall", fair=False)
def white(scene: PictureScene, rng: np.random.Generator) -> PictureScene:
    grey = rng.uniform(0.6, 0.8)
    wall = Surface(grey * rng.uniform(0.93, 0.97), mottle=0.02, mottle_size=3 * MM)
    return replace(scene, face=Surface(grey, mottle=0.01), background=wall)


# The door is drawn that much thicker than the localizer is told.
for _extra in (0.3, 2.0, 10.0):
    CONDITIONS[f"{_extra:g} mm thicker than its recipe"] = _Condition(
        plain, fair=_extra < 1.0, beams=_extra > 1.0
    )


def pictures(name: str, count: int, seed: int = 7) -> Iterator[ConditionPicture]:
    """Pictures of one condition, equal for equal seeds."""
    condition, layout = CONDITIONS[name], load_layout()
    camera = marked_cameras()[0] if condition.marked else SceneCamera.load()
    extra = float(name.split(" ")[0]) * MM if name.endswith("than its recipe") else 0.0
    for number in range(count):
        rng = np.random.default_rng((seed, number, *name.encode()))
        scene = condition.change(plain_scene(rng, camera, layout), rng)
        thickness, scene = scene.thickness, replace(scene, thickness=scene.thickness + extra)
        has = condition.fair, condition.marked, condition.beams, condition.bow
        yield ConditionPicture(name, *has, scene, thickness, int(rng.integers(2**31)))
