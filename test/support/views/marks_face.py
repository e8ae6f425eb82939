"""What is cut into a face or drawn on it, most of it in a line beside an edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.views.face import Patch
from support.views.finish import Finish
from support.views.noise import look_up, smooth
from support.views.optics import Array

HINGE, BOTTOM = "hinge", "bottom"


def across(edge: str, patch: Patch) -> Array:
    """Distance from an edge into the face, shape (n,) [m]."""
    return patch.y if edge == HINGE else patch.z


def along(edge: str, patch: Patch) -> Array:
    """Place along an edge from the corner, shape (n,) [m]."""
    return patch.z if edge == HINGE else patch.y


def lean(edge: str, patch: Patch, slope: Array) -> None:
    """Tilt the normals of a patch away from an edge by slopes, shape (n,)."""
    if edge == HINGE:
        patch.tilt_y = patch.tilt_y + slope
    else:
        patch.tilt_z = patch.tilt_z + slope


@dataclass(frozen=True)
class Groove:
    """A V-groove, round groove, slot or moulding that runs beside an edge.

    Attributes:
        edge: HINGE or BOTTOM.
        middle: From the edge [m].
        half: Half its width [m].
        depth: Slope of its walls.
        shape: v, round, slot or ogee.
        filled: Albedo of what fills a slot; None for nothing.
        turn: Against the edge [rad].
    """

    edge: str
    middle: float
    half: float
    depth: float
    shape: str
    filled: float | None = None
    turn: float = 0.0

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        t = (across(self.edge, patch) - self.middle - self.turn * along(self.edge, patch)) / self.half
        inside = np.abs(t) < 1.0
        if self.shape == "slot":
            wall = smooth((1.0 - np.abs(t)) * self.half / 4e-4)
            if self.filled is not None:
                patch.paint(inside, self.filled, 11.0)
            patch.open = np.where(inside, patch.open * (0.45 + 0.35 * wall), patch.open)
        else:
            if self.shape == "v":
                slope = -np.sign(t)
            elif self.shape == "round":
                slope = -np.sin(0.5 * np.pi * t)
            else:
                slope = -np.sin(2.0 * np.pi * t)
            lean(self.edge, patch, np.where(inside, self.depth * slope, 0.0))
            patch.open = np.where(
                inside, patch.open * (1.0 - 0.35 * self.depth * (1.0 - np.abs(t))), patch.open
            )
        patch.mark = np.where(inside, 12.0 + (t > 0.0), patch.mark)


@dataclass(frozen=True)
class Line:
    """A line drawn or burnt beside an edge: a Gaussian across, with gaps where the hand was light.

    Attributes:
        edge: HINGE or BOTTOM.
        inside: From the edge [m].
        sigma: Of its width [m].
        dark: Share of light that it takes.
        ragged: 0 for a machine's line, 1 for a hand's.
        turn: Against the edge [rad].
    """

    edge: str
    inside: float
    sigma: float
    dark: float
    ragged: float = 0.0
    turn: float = 0.0

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        t = along(self.edge, patch)
        strength = 1.0 + self.ragged * 0.4 * look_up("cloud", t / 1e-4, 0.0 * t + 55.0)
        strength = strength + self.ragged * 0.3 * look_up("speckle", patch.y / 1e-4, patch.z / 1e-4)
        far = across(self.edge, patch) - self.inside - self.turn * t
        profile = np.exp(-0.5 * (far / self.sigma) ** 2)
        patch.albedo = patch.albedo * (1.0 - np.clip(self.dark * strength * profile, 0.0, 0.97))


@dataclass(frozen=True)
class Sheet:
    """A film, label or strip of tape on the face inside its outline.

    Attributes:
        middle: Of the sheet (y, z) [m].
        half: Half its sides [m].
        turn: Of the sheet [rad].
        albedo: Of paper; None for clear film.
        tone: Share of light that clear film lets back.
        gloss: Share of light that shines.
        ragged: How far its border strays [m].
        printed: Whether there are lines of print on it.
    """

    middle: tuple[float, float]
    half: tuple[float, float]
    turn: float
    albedo: float | None
    tone: float = 1.0
    gloss: float = 0.0
    ragged: float = 0.0
    printed: bool = False

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        y, z = patch.y - self.middle[0], patch.z - self.middle[1]
        u, v = c * y + s * z, c * z - s * y
        inside = np.minimum(self.half[0] - np.abs(u), self.half[1] - np.abs(v))
        if self.ragged:
            inside = inside + self.ragged * look_up("cloud", patch.y / 1e-4, patch.z / 1e-4)
        on = inside > 0.0
        if self.albedo is None:
            patch.albedo = np.where(on, patch.albedo * self.tone, patch.albedo)
        else:
            paper = self.albedo * (1.0 + 0.02 * look_up("speckle", u / 1e-4, v / 1e-4))
            if self.printed:
                dash = look_up("streak", v / 3e-4, u / 2e-4) > 0.3
                row = np.mod(v / 3e-3, 1.0) < 0.45
                edge_free = inside > 2.5e-3
                paper = np.where(dash & row & edge_free, 0.06, paper)
            patch.albedo = np.where(on, paper, patch.albedo)
        patch.gloss = np.where(on, self.gloss, patch.gloss)
        # The border of the sheet stands up a little and throws light back or a thin shadow.
        patch.open = patch.open * (1.0 - 0.18 * np.exp(-(((inside + 5e-5) / 8e-5) ** 2)))
        patch.mark = np.where(on, 21.0, patch.mark)


@dataclass(frozen=True)
class Pane:
    """A glazed opening with a bead about it: glass begins `at` from the hinge edge, the bead is before it.

    Attributes:
        at: From the hinge edge [m].
        bead: Width of the bead [m].
        above: From the bottom edge [m].
        glass: Albedo that stands for what is seen in the glass.
    """

    at: float
    bead: float
    above: float
    glass: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        y, z = patch.y - self.at, patch.z - self.above
        inside = np.minimum(y, z)
        beside = y < z
        bead = (inside > -self.bead) & (inside <= 0.0)
        slope = np.where(bead, 0.8 * np.sin(np.pi * (inside / self.bead + 1.0) + 0.5), 0.0)
        patch.tilt_y = patch.tilt_y + np.where(beside, slope, 0.0)
        patch.tilt_z = patch.tilt_z + np.where(beside, 0.0, slope)
        patch.mark = np.where(bead, 31.0 + beside, patch.mark)
        seam = np.exp(-(((inside + self.bead) / 1.5e-4) ** 2))
        patch.open = patch.open * (1.0 - 0.6 * seam)
        tone = self.glass * (1.0 + 0.3 * look_up("cloud", y / 1e-3, z / 1e-3))
        patch.paint(inside > 0.0, tone, 33.0, 0.2)


@dataclass(frozen=True)
class Ripple:
    """Marks of the planer's knives across the grain."""

    pitch: float
    slope: float

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        patch.tilt_z = patch.tilt_z + self.slope * np.sin(2.0 * np.pi * patch.z / self.pitch)


@dataclass(frozen=True)
class Lipping:
    """Solid wood along the edges, or a band with its line of glue.

    Attributes:
        width: Of the strip [m].
        finish: Of the strip.
        glue: Albedo of the line of glue; None for no line.
        bottom: Whether the bottom edge has one too.
    """

    width: float
    finish: Finish
    glue: float | None
    bottom: bool

    def on(self, patch: Patch) -> None:
        """Change the patch."""
        inner = patch.y - self.width
        if self.bottom:
            inner = np.minimum(inner, patch.z - self.width)
        strip = self.finish.at(patch.y, patch.z)
        if self.bottom:
            strip = np.where(patch.z < self.width, self.finish.at(patch.z, patch.y), strip)
        patch.paint(inner < 0.0, strip, 41.0, self.finish.gloss)
        if self.glue is not None:
            seam = np.exp(-((inner / 1.1e-4) ** 2))
            patch.albedo = patch.albedo * (1.0 - seam) + self.glue * seam
