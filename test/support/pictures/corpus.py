"""A seeded corpus of pictures as a workshop gives them, each with its truth.

Most scenes are acceptable by design: a person who looks at the picture would read the two
edges off it without doubt. That is stated by what the scene is made of, never by what an
estimator says: the step at both edges is several times the texture and the noise, at least
two thirds of each edge is free, the optics are near focus and the door is within the limits.
The other scenes break one of these and may be refused; a pose they give must still be right.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.cell.places.layout import CellLayout, DoorOffset, load_layout
from doormill_ros.simulation.picture.scene import (
    BackEdge,
    Edges,
    Light,
    PictureScene,
    SceneCamera,
    Sensor,
    Surface,
)
from doormill_ros.units import DEG, MM
from support.pictures import clutter

SQUARENESS = 1.0e-4  # standard deviation of a saw's right angle, 0.1 mm in a metre [rad]
HARD = ("defocused", "covered", "faint", "glare", "dark", "outside", "no door", "chipped away")


@dataclass(frozen=True, eq=False)
class CorpusPicture:
    """One picture of the corpus: render it with `render_picture(scene, seed)`.

    Attributes:
        scene: The scene with its true pose.
        seed: Of its random fields.
        acceptable: Whether a person would measure it.
        label: "workshop", or what makes it unacceptable.
    """

    scene: PictureScene
    seed: int
    acceptable: bool
    label: str


def workshop_scene(rng: np.random.Generator, camera: SceneCamera, layout: CellLayout) -> PictureScene:
    """An acceptable scene with the troubles of a workshop, each in a random measure."""
    limits = layout.limits
    offset = DoorOffset(*(rng.uniform(-0.99, 0.99, 3) * [limits.y, limits.z, limits.rotation]))
    low = rng.random() < 0.2  # a fifth of the pictures is of low contrast
    step = rng.uniform(0.09, 0.16) if low else rng.uniform(0.2, 0.6)
    darker = rng.uniform(0.06, 0.9 - step if low else 0.25)
    bright, dark = min(darker + step, 0.9), darker
    face, background = (bright, dark) if rng.random() < 0.75 else (dark, bright)
    back_edge, lip_step = None, step
    if rng.random() < 0.2:
        # A rebate's lip far behind the face, or a broad bevel just behind it; a dark face shows it brighter.
        hinge, setback = (rng.uniform(12, 17), 25.0) if rng.random() < 0.5 else (rng.uniform(2.5, 5), 3.0)
        shade = rng.uniform(0.35, 0.7) if face > 0.3 else rng.uniform(1.5, 2.5)
        if face * abs(shade - 1) > 0.08:
            bottom = hinge if rng.random() < 0.4 else 0.0
            back_edge = BackEdge(hinge * MM, bottom * MM, setback * MM, shade)
            lip_step = face * abs(shade - 1)
    calm = min(step, lip_step) / face / 6.0  # the step stays six times the texture's standard deviation
    grain = min(rng.uniform(0, 0.10), calm) if rng.random() < 0.7 else 0.0
    mottle = min(rng.uniform(0, 0.05), calm / 2)
    along_edge = rng.random() < 0.75
    gradient = tuple(rng.uniform(-0.25, 0.25, 2))
    # Automatic exposure: the brightest surface stays below white.
    brightest = max(bright, face * (back_edge.brightness if back_edge else 1)) * (1 + 2 * (grain + mottle))
    light = Light(
        level=min(rng.uniform(0.85, 1.1), 0.95 / (brightest * (1 + abs(gradient[0]) + abs(gradient[1])))),
        gradient=gradient,
        vignetting=rng.uniform(0, 0.25),
        banding=rng.uniform(0, 0.03) if rng.random() < 0.3 else 0.0,
        shadows=(clutter.shadow(rng),) if not low and rng.random() < 0.3 else (),
    )
    blots = clutter.dust(rng, rng.poisson(rng.choice([5, 30, 90])))
    if rng.random() < 0.3:
        blots = clutter.beam(rng) + blots
    if rng.random() < 0.3:
        blots += clutter.screw(rng)
    if rng.random() < 0.3:
        blots += clutter.clamp(rng)
    defocus = rng.uniform(0.5, 2.5) if rng.random() < 0.35 else 0.0
    return PictureScene(
        width=rng.uniform(0.29, 1.35),
        thickness=rng.uniform(0.030, 0.100),
        offset=offset,
        face=Surface(
            face,
            mottle=mottle,
            mottle_size=rng.uniform(0.5, 4) * MM,
            grain=grain,
            grain_width=rng.uniform(0.4, 1.5) * MM,
            grain_angle=rng.normal(0, 0.7 * DEG) + (0 if along_edge else np.pi / 2),
        ),
        background=Surface(
            background,
            mottle=min(rng.uniform(0, 0.1), step / background / 8),
            mottle_size=rng.uniform(1, 8) * MM,
        ),
        edges=Edges(
            roughness=0.02 * MM,
            correlation=2.0 * MM,
            squareness=rng.normal(0, SQUARENESS),
            softness=rng.uniform(0.05, 0.25) * MM if rng.random() < 0.3 else 0.0,
            chips=tuple(clutter.chips(rng, rng.choice([0.5, 2.0, 5.0]))),
        ),
        back_edge=back_edge,
        light=light,
        blots=tuple(blots),
        sensor=Sensor(
            blur=rng.uniform(0.7, 1.6),
            defocus=defocus,
            read_noise=rng.uniform(0.5, 2.5),
            gain=rng.uniform(0.005, 0.06),
        ),
        camera=camera,
        layout=layout,
    )


def spoil(scene: PictureScene, label: str, rng: np.random.Generator) -> PictureScene:
    """The scene made unacceptable in the way `label` says, one of HARD.

    Raises:
        ValueError: No such way.
    """
    if label == "defocused":
        return replace(scene, sensor=replace(scene.sensor, defocus=rng.uniform(7, 12)))
    if label == "covered":
        blots = clutter.clamp(rng, (0.45, 0.6)) + clutter.clamp(rng, (0.45, 0.6))
        return replace(scene, blots=scene.blots + tuple(blots))
    if label == "faint":
        face = scene.face.brightness
        behind = Surface(face * rng.uniform(0.985, 1.015), mottle=0.05, mottle_size=2 * MM)
        return replace(scene, background=behind, back_edge=None)
    if label == "glare":
        return replace(scene, light=replace(scene.light, level=rng.uniform(4, 12)))
    if label == "dark":
        return replace(scene, light=replace(scene.light, level=rng.uniform(0.002, 0.03)))
    if label == "outside":
        side = rng.integers(3)
        values = [scene.offset.y, scene.offset.z, scene.offset.rotation]
        limits = scene.layout.limits
        values[side] = (
            rng.choice([-1, 1]) * rng.uniform(1.05, 2.0) * (limits.y, limits.z, limits.rotation)[side]
        )
        return replace(scene, offset=DoorOffset(*values))
    if label == "no door":
        return replace(scene, offset=DoorOffset(0.3, 0.3, 0.0), back_edge=None)
    if label == "chipped away":
        chips = clutter.chips(rng, 40.0)
        return replace(scene, edges=replace(scene.edges, chips=tuple(chips)))
    raise ValueError(f"no way {label!r} to spoil a picture, allowed are {HARD}")


def corpus(count: int, seed: int = 2018, hard_share: float = 0.12) -> list[CorpusPicture]:
    """`count` scenes; `hard_share` of them unacceptable, in turn in every way of HARD."""
    camera, layout = SceneCamera.load(), load_layout()
    out = []
    for i in range(count):
        rng = np.random.default_rng((seed, i))
        scene = workshop_scene(rng, camera, layout)
        number = int(i * hard_share)
        hard = int((i + 1) * hard_share) > number
        label = HARD[number % len(HARD)] if hard else "workshop"
        if hard:
            scene = spoil(scene, label, rng)
        out.append(CorpusPicture(scene, int(rng.integers(2**31)), not hard, label))
    return out
