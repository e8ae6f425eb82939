"""Random views of a workshop, each reproducible by its number and the seed of its series."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from support.views import features_about, features_face, features_light, features_taking
from support.views.backdrops import Backdrop
from support.views.draft import Draft
from support.views.finish import Finish
from support.views.light import Lamp
from support.views.optics import Place
from support.views.view import Taking, View

Feature = Callable[[Draft], None]
_BACKDROPS = ("wall_close", "mirror", "shadow_outside", "bright_hall", "floor", "tiles")
#: Features that set the face or the backdrop anew, and so go before those that add to it.
FIRST = ("dark_door", "veneer_joint", "glossy", *_BACKDROPS)
SINGLE = 0.4  #: share of views with one feature
NONE = 0.05  #: share of views with none
#: Of these a view has one at most: another would undo it.
ONE_BACKDROP = {*_BACKDROPS, "low_contrast", "dark_door"}


def _of(module: ModuleType) -> dict[str, Feature]:
    return {
        name: thing
        for name, thing in vars(module).items()
        if callable(thing)
        and getattr(thing, "__module__", "") == module.__name__
        and not name.startswith("_")
    }


#: Every feature by its name.
FEATURES: dict[str, Feature] = {
    name: feature
    for module in (features_face, features_about, features_light, features_taking)
    for name, feature in _of(module).items()
}


def _bare(rng: np.random.Generator) -> Draft:
    limits = load_layout().limits
    thickness = float(rng.choice([0.035, 0.040, 0.045, 0.050, 0.055, 0.060]))
    place = Place(
        float(rng.choice([0.61, 0.735, 0.86, 0.985, 1.11])),
        thickness,
        DoorOffset(
            float(rng.uniform(-limits.y, limits.y)),
            float(rng.uniform(-limits.z, limits.z)),
            float(rng.uniform(-limits.rotation, limits.rotation)),
        ),
    )
    lamps = [
        Lamp(
            (float(rng.uniform(-1.5, -0.3)), float(rng.uniform(-0.9, 0.9)), float(rng.uniform(0.0, 1.4))),
            1.0,
            float(rng.uniform(0.005, 0.12)),
        )
    ]
    if rng.random() < 0.5:
        there = (float(rng.uniform(-1.5, -0.3)), float(rng.uniform(-0.9, 0.9)), float(rng.uniform(0.0, 1.4)))
        lamps.append(Lamp(there, float(rng.uniform(0.1, 0.7)), float(rng.uniform(0.01, 0.1))))
    seed = (float(rng.uniform(0, 1000)), float(rng.uniform(0, 1000)))
    backdrop = Backdrop(
        str(rng.choice(["curtain", "concrete", "paint", "hall"])),
        float(rng.uniform(0.15, 0.8)),
        float(rng.choice([0.04, 0.08, 0.2, 0.5])),
        seed,
    )
    taking = Taking(
        level=float(rng.uniform(0.3, 0.75)),
        psf=float(rng.uniform(0.7, 1.3)),
        aperture=float(rng.uniform(3e-4, 1.5e-3)),
        focus=float(rng.uniform(-0.005, 0.005)),
        vignetting=float(rng.uniform(0.0, 0.3)),
        photons=float(rng.uniform(4000, 20000)),
        read=float(rng.uniform(0.3, 1.2)),
    )
    bare = Draft(
        rng, place, Finish("lacquer", 0.6), backdrop, lamps, float(rng.uniform(0.05, 0.4)), taking, thickness
    )
    bare.finish = bare.some_finish()
    return bare


def _names(rng: np.random.Generator) -> tuple[str, ...]:
    share = rng.random()
    if share < NONE:
        return ()
    count = 1 if share < NONE + SINGLE else int(rng.integers(2, 5))
    names = [str(name) for name in rng.permutation(sorted(FEATURES))]
    chosen: list[str] = []
    for name in names:
        if name in ONE_BACKDROP and ONE_BACKDROP.intersection(chosen):
            continue
        chosen.append(name)
        if len(chosen) == count:
            break
    return tuple(sorted(chosen, key=lambda name: (name not in FIRST, names.index(name))))


def view_of(number: int, seed: int, features: tuple[str, ...] | None = None) -> View:
    """View `number` of the series of a seed.

    Args:
        number: From 0.
        seed: Of the series.
        features: Names of `FEATURES` to put in, in this order; None draws them.
    """
    rng = np.random.default_rng((seed, number))
    names = _names(rng) if features is None else features
    draft = _bare(rng)
    for name in names:
        FEATURES[name](draft)
    return draft.finished(number, seed, names)
