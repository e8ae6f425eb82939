"""What closes the view behind the door."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.views.light import Light
from support.views.noise import look_up, smooth
from support.views.optics import Array, Rays


@dataclass(frozen=True, eq=False)
class Backdrop:
    """A wall, curtain or deep room behind the door.

    Attributes:
        kind: curtain, concrete, hall, paint, tiles or mirror.
        x: Depth of its plane behind the face [m].
        albedo: Share of light that comes back.
        seed: Where its tiles are read [texels].
        texel: Size of a texel on it [m].
        floor: z of a floor before it [m]; None for none.
        thickness: Of the door, of which a mirror shows the rear [m].
        glow: Own light of windows and lamps in a hall.
    """

    kind: str
    x: float
    albedo: float
    seed: tuple[float, float]
    texel: float = 4e-4
    floor: float | None = None
    thickness: float = 0.05
    glow: float = 0.0

    def look(self, rays: Rays, light: Light) -> tuple[Array, Array, Array]:
        """Radiance, cover and number of what each ray meets, shapes (n,)."""
        y, z = rays.at(self.x)
        radiance = self._wall(y, z, rays, light)
        mark = np.zeros_like(y)
        if self.floor is not None:
            below = z < self.floor
            s = (self.floor - rays.centre[2]) / np.minimum(rays.b, -1e-4)
            x_floor = rays.centre[0] + s
            y_floor = rays.centre[1] + s * rays.a
            zero = np.zeros_like(y)
            tone = (
                0.8
                * self.albedo
                * (1.0 + 0.15 * look_up("cloud", y_floor / 1e-3, x_floor / 1e-3 + self.seed[0]))
            )
            lit, _ = light.on(
                (x_floor, y_floor, zero + self.floor), (zero, zero, zero + 1.0), 0.0, rays.centre, True
            )
            radiance = np.where(below, tone * lit, radiance)
            mark = np.where(below, 1.0, 0.0)
        return radiance, np.ones_like(y), mark

    def _wall(self, y: Array, z: Array, rays: Rays, light: Light) -> Array:
        u, v = y / self.texel + self.seed[0], z / self.texel + self.seed[1]
        tilt: Array = np.zeros_like(y)
        tone: Array = np.ones_like(y)
        shine: Array = np.zeros_like(y)
        if self.kind == "curtain":  # folds hang straight down
            fold = (y + 4e-3 * look_up("cloud", u * 0.2, v * 0.1)) / 0.035
            tilt = 0.7 * np.sin(2.0 * np.pi * fold).astype(np.float32)
            tone = 1.0 + 0.06 * look_up("speckle", u, v)
        elif self.kind == "concrete":
            stain = smooth((look_up("cloud", u * 0.3, v * 0.3) - 0.8) / 0.6)
            hole = smooth((look_up("speckle", u * 0.12, v * 0.12) - 2.6) / 0.3)
            tone = (1.0 + 0.1 * look_up("cloud", u, v) + 0.04 * look_up("speckle", u, v)) * (
                1.0 - 0.35 * stain
            )
            tone = tone * (1.0 - 0.5 * hole)
        elif self.kind == "tiles":
            side = 110.0 * self.texel
            joint = np.minimum(
                np.abs(np.mod(y + 1.0, side) - side / 2), np.abs(np.mod(z + 1.0, side) - side / 2)
            )
            tone = 1.0 + 0.02 * look_up("cloud", u, v) - 0.6 * smooth((1.5e-3 - joint) / 4e-4)
        elif self.kind == "paint":
            tone = 1.0 + 0.015 * look_up("cloud", u * 0.5, v * 0.5)
        elif self.kind == "hall":
            tone = 1.0 + 0.35 * look_up("cloud", u * 0.15, v * 0.15)
            spot = look_up("cloud", u * 0.5 + 400.0, v * 0.5)
            shine = self.glow * smooth((spot - 2.0) / 0.25)
        elif self.kind == "mirror":
            return self._mirrored(y, z, rays, light)
        size = 1.0 / np.sqrt(1.0 + tilt * tilt)
        lit, _ = light.on(
            (np.full_like(y, self.x), y, z), (-size, tilt * size, 0.0 * y), 0.0, rays.centre, True
        )
        found: Array = np.maximum(self.albedo * tone, 0.005) * lit + shine
        return found

    def _mirrored(self, y: Array, z: Array, rays: Rays, light: Light) -> Array:
        # The ray goes back to the plane of the rear face: on the door it sees dark wood, beside it the room.
        back = self.x - self.thickness
        y_back, z_back = y + rays.a * back, z + rays.b * back
        inside = np.minimum(y_back, z_back)
        room = self.albedo * (1.0 + 0.15 * look_up("cloud", y_back / 2e-3 + self.seed[0], z_back / 2e-3))
        brushed = 1.0 + 0.04 * look_up("streak", z / 2e-4 + self.seed[1], y / 2e-4)
        rear = 0.25 * self.albedo + 0.5 * light.ambient
        found: Array = np.where(inside > 0.0, rear, room) * brushed
        return found
