"""A view while it is being put together."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from support.views.backdrops import Backdrop
from support.views.face import Face, Mark
from support.views.finish import PLAIN, WOODS, Finish
from support.views.light import Lamp, Leaf, Light, Rod, Screen
from support.views.optics import Place
from support.views.solids import Bar, Box
from support.views.view import Taking, View


@dataclass
class Draft:
    """What features change; see `View` for its parts.

    Attributes:
        rng: Of this view.
        place: Of the door.
        finish: Of the face.
        backdrop: Behind all.
        lamps: About the camera.
        ambient: Light from everywhere.
        taking: How the picture is taken.
        step: Depth of the door's body where it may cast a shadow [m].
    """

    rng: np.random.Generator
    place: Place
    finish: Finish
    backdrop: Backdrop
    lamps: list[Lamp]
    ambient: float
    taking: Taking
    step: float
    marks: list[Mark] = field(default_factory=list)
    behind: list[Box | Bar] = field(default_factory=list)
    before: list[Box | Bar] = field(default_factory=list)
    shades: list[Rod | Screen | Leaf] = field(default_factory=list)

    def uniform(self, low: float, high: float) -> float:
        """An even deviate."""
        return float(self.rng.uniform(low, high))

    def one_of(self, *choices: Any) -> Any:
        """One of some things, each as likely."""
        return choices[int(self.rng.integers(len(choices)))]

    def chance(self, share: float) -> bool:
        """Whether something happens."""
        return bool(self.rng.random() < share)

    def some_finish(self, albedo: float | None = None, kinds: tuple[str, ...] = WOODS + PLAIN) -> Finish:
        """A surface of any kind."""
        kind = self.one_of(*kinds)
        usual = {"walnut": (0.15, 0.28), "primer": (0.7, 0.85), "lacquer": (0.3, 0.85)}.get(
            kind, (0.35, 0.65)
        )
        return Finish(
            kind,
            self.uniform(*usual) if albedo is None else albedo,
            self.uniform(0.02, 0.12) if kind == "lacquer" or self.chance(0.3) else 0.0,
            (self.uniform(0, 1000), self.uniform(0, 1000)),
            self.uniform(-0.03, 0.03),
            self.uniform(0.0015, 0.008),
            self.uniform(0.02, 0.06),
        )

    def take(self, **changes: Any) -> None:
        """Change how the picture is taken."""
        self.taking = replace(self.taking, **changes)

    def hang(self, **changes: Any) -> None:
        """Change the backdrop."""
        self.backdrop = replace(self.backdrop, **changes)

    def finished(self, number: int, seed: int, features: tuple[str, ...]) -> View:
        """The view; what is told of the thickness has 0.1 mm of standard deviation."""
        told = self.place.thickness + float(np.clip(self.rng.normal(0.0, 1e-4), -2.5e-4, 2.5e-4))
        return View(
            number,
            seed,
            features,
            self.place,
            told,
            Face(self.place, self.finish, tuple(self.marks)),
            self.backdrop,
            Light(tuple(self.lamps), self.ambient, (Leaf(self.step), *self.shades)),
            self.taking,
            tuple(self.behind),
            tuple(self.before),
        )
