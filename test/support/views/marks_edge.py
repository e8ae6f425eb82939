"""What is at the very edges of a face: how they were broken, what was torn off them, what sticks to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from support.views.face import Patch
from support.views.marks_face import BOTTOM, HINGE, across, along, lean
from support.views.noise import look_up


@dataclass(frozen=True)
class Arris:
    """A rounded or chamfered arris of both edges.

    Attributes:
        width: Of the arris as it is seen [m].
        round: Whether it is round; else it is a chamfer.
        steep: Slope of the chamfer, or of the round at its end.
        tone: Factor of the albedo: above 1 where paint is rubbed through, below 1 where it was burnt.
    """

    width: float
    round: bool
    steep: float
    tone: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        for edge in (HINGE, BOTTOM):
            t = 1.0 - across(edge, patch) / self.width
            broken = t > 0.0
            slope = self.steep * (np.clip(t, 0.0, 1.0) if self.round else 1.0)
            lean(edge, patch, np.where(broken, -slope, 0.0))
            patch.albedo = np.where(broken, np.clip(patch.albedo * self.tone, 0.01, 1.0), patch.albedo)
            patch.mark = np.where(broken, 51.0, patch.mark)


@dataclass(frozen=True)
class Chips:
    """Pieces broken out of the edges: (edge, along, across and along half sizes) each [m]."""

    pieces: Sequence[tuple[str, float, float, float]]
    seed: float
    albedo: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        for edge, place, deep, half in self.pieces:
            s, d = along(edge, patch), across(edge, patch)
            ragged = 1.0 + 0.35 * look_up("cloud", s / 4e-5 + self.seed, d / 4e-5)
            near = ((s - place) / half) ** 2 + (d / deep) ** 2
            gone = near < ragged
            pale = (near < ragged * 1.9) & ~gone
            patch.paint(pale, self.albedo, 61.0)
            patch.cover = np.where(gone, 0.0, patch.cover)


@dataclass(frozen=True)
class Overhang:
    """Veneer that stands out over a stretch of an edge: edge, from, to, how far [m]."""

    edge: str
    first: float
    last: float
    out: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        s = along(self.edge, patch)
        far = self.out * (0.7 + 0.3 * look_up("cloud", s / 1e-4, 0.0 * s + 17.0))
        beside = (s > self.first) & (s < self.last)
        more = patch.step(across(self.edge, patch) + np.maximum(far, 0.0)) * beside
        sound = patch.step(patch.z if self.edge == HINGE else patch.y)
        patch.cover = np.maximum(patch.cover, more * sound)


@dataclass(frozen=True)
class TearOut:
    """Fibres torn out of the face beside an edge: edge, from, to, how deep [m]; the ground is paler."""

    edge: str
    first: float
    last: float
    deep: float
    tone: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        s, d = along(self.edge, patch), across(self.edge, patch)
        reach = self.deep * look_up("cloud", s / 6e-5, d / 6e-4 + 91.0)
        torn = (d < reach) & (s > self.first) & (s < self.last)
        rough = self.tone * (1.0 + 0.15 * look_up("speckle", patch.y / 1e-4, patch.z / 1e-4))
        patch.albedo = np.where(torn, np.clip(patch.albedo * rough, 0.01, 1.0), patch.albedo)
        patch.open = np.where(torn & (d > reach - 1.5e-4), patch.open * 0.6, patch.open)
        patch.mark = np.where(torn, 62.0, patch.mark)
        fringe = (d < reach * 0.12 - 1e-4) & torn & (d > 0.0)
        patch.cover = np.where(fringe, 0.0, patch.cover)


@dataclass(frozen=True)
class Tape:
    """Masking tape laid over an edge: edge, from, to, how far in and out [m]."""

    edge: str
    first: float
    last: float
    inside: float
    outside: float
    albedo: float
    turn: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        s = along(self.edge, patch) + self.turn * across(self.edge, patch)
        d = across(self.edge, patch) - self.turn * along(self.edge, patch)
        torn = 4e-4 * look_up("cloud", d / 6e-5, s / 6e-4)
        on = (s > self.first + torn) & (s < self.last + torn) & (d < self.inside) & (d > -self.outside)
        crepe = self.albedo * (1.0 + 0.05 * look_up("streak", s / 1.5e-4, d / 1.5e-4))
        patch.paint(on, crepe, 71.0)
        patch.cover = np.where(on, 1.0, patch.cover)


@dataclass(frozen=True)
class Drop:
    """A drop of glue on an edge, half on and half beside it: edge, place along it, radius [m], what it lets back."""

    edge: str
    place: float
    radius: float
    tone: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        s, d = along(self.edge, patch) - self.place, across(self.edge, patch)
        far = np.hypot(s, d * (0.8 if self.edge == HINGE else 1.2)) / self.radius
        on = far < 1.0
        bulge = np.where(on, 1.4 * far, 0.0) / np.maximum(far * self.radius, 1e-7)
        lean(self.edge, patch, bulge * d)
        lean(BOTTOM if self.edge == HINGE else HINGE, patch, bulge * s)
        patch.paint(on, self.tone, 72.0, 0.5)
        patch.cover = np.where(on, 1.0, patch.cover)


@dataclass(frozen=True)
class Dust:
    """Sawdust that lies against the bottom edge, and chips of wood about it.

    Attributes:
        first: Of the heap along the edge [m].
        last: Of the heap along the edge [m].
        high: Of the heap above the edge [m].
        flakes: y, z, half length, half width, turn of each chip of wood [m], [rad].
        albedo: Of the dust.
        seed: Of its outline [texels].
    """

    first: float
    last: float
    high: float
    flakes: Sequence[tuple[float, float, float, float, float]]
    albedo: float
    seed: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        y, z = patch.y, patch.z
        t = (y - self.first) / (self.last - self.first)
        hump = 4.0 * t * (1.0 - t)
        rough = 3e-4 * look_up("speckle", y / 1e-4, 0.0 * y + self.seed)
        top = self.high * hump * (0.7 + 0.3 * look_up("cloud", y / 1e-4, 0.0 * y + self.seed)) + rough
        heap = (hump > 0.0) & (z < top) & (z > -9e-3 * np.sqrt(np.maximum(hump, 0.0)) - rough)
        tone = self.albedo * (1.0 + 0.16 * look_up("speckle", y / 1e-4 + self.seed, z / 1e-4))
        patch.paint(heap, tone, 81.0)
        patch.cover = np.where(heap, 1.0, patch.cover)
        for number, (y0, z0, half, thin, turn) in enumerate(self.flakes):
            c, s = np.cos(turn), np.sin(turn)
            u, v = c * (y - y0) + s * (z - z0), c * (z - z0) - s * (y - y0)
            flake = (u / half) ** 2 + (v / thin) ** 2 < 1.0
            patch.paint(flake, self.albedo * (1.1 + 0.2 * np.sin(number)), 82.0 + number)
            patch.cover = np.where(flake, 1.0, patch.cover)
