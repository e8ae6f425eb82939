"""What a face is made of: how light it is at each place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.views.noise import look_up
from support.views.optics import Array

TEXEL = 1e-4  #: of the tiles on a face [m]
WOODS = ("oak", "pine", "beech", "walnut", "veneer", "print")
PLAIN = ("lacquer", "mdf", "primer")


@dataclass(frozen=True)
class Finish:
    """One surface.

    Attributes:
        kind: One of WOODS or PLAIN.
        albedo: Mean share of light that comes back, 0 to 1.
        gloss: Of the lacquer.
        seed: (u, v) from where the tiles are read [texels].
        turn: Of the grain against door z [rad].
        ring: Mean width of a growth ring [m].
        leaf: Width of a leaf of mirror-matched veneer [m].
    """

    kind: str
    albedo: float
    gloss: float = 0.0
    seed: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0
    ring: float = 0.004
    leaf: float = 0.03

    def at(self, y: Array, z: Array) -> Array:
        """Albedo at places on the face, shapes (n,) [m]."""
        if self.kind in PLAIN:
            return self._painted(y, z)
        c, s = np.float32(np.cos(self.turn)), np.float32(np.sin(self.turn))
        across, along = c * y + s * z, c * z - s * y
        joint: Array = np.ones_like(y)
        if self.kind == "veneer":
            phase = np.mod(across / self.leaf + self.seed[0] / 97.0, 2.0)
            to_joint = np.abs(phase - 1.0)
            across = to_joint * self.leaf
            joint = 1.0 - 0.12 * np.exp(-(((1.0 - np.abs(2.0 * to_joint - 1.0)) * self.leaf / 1.6e-4) ** 2))
        u, v = across / TEXEL + self.seed[0], along / TEXEL + self.seed[1]
        warp = look_up("cloud", u * 0.25, v * 0.04)
        phase = across / self.ring + 0.9 * warp
        ring = np.mod(phase, 1.0) ** 2  # early wood pale, darker until the ring ends
        ring = np.where(np.mod(phase, 1.0) > 0.9, (1.0 - np.mod(phase, 1.0)) * 8.1, ring)
        strength = {"oak": 0.14, "pine": 0.24, "beech": 0.05, "walnut": 0.2, "veneer": 0.16, "print": 0.12}[
            self.kind
        ]
        fibre = look_up("streak", u, v) * (0.035 if self.kind != "beech" else 0.02)
        shade = 1.0 - strength * (ring - 0.3) + fibre
        if self.kind in ("oak", "walnut", "beech", "veneer"):
            deep = 0.25 if self.kind != "beech" else 0.12
            shade = shade * (1.0 - deep * look_up("pore", u + 300.0, v + 77.0))
        if self.kind == "print":  # dots of the printing cylinder
            shade = shade * (1.0 + 0.03 * np.sin(2.0 * np.pi * y / 3.2e-4) * np.sin(2.0 * np.pi * z / 3.2e-4))
        found: Array = np.clip(self.albedo * shade * joint, 0.01, 1.0)
        return found

    def _painted(self, y: Array, z: Array) -> Array:
        u, v = y / TEXEL + self.seed[0], z / TEXEL + self.seed[1]
        if self.kind == "mdf":
            shade = 1.0 + 0.045 * look_up("speckle", u, v) + 0.02 * look_up("cloud", u, v)
        elif self.kind == "primer":  # roller stipple
            shade = 1.0 + 0.012 * look_up("speckle", u * 0.3, v * 0.3) + 0.01 * look_up("cloud", u, v)
        else:
            shade = 1.0 + 0.008 * look_up("cloud", u * 0.5, v * 0.5)
        found: Array = np.clip(self.albedo * shade, 0.01, 1.0)
        return found
