"""The face of the door: its material, what was done to it, and its outline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from support.views.finish import Finish
from support.views.light import Light
from support.views.optics import SIDE, Array, Place, Rays

NO_MARK = -1.0


@dataclass
class Patch:
    """Places on the plane of the face and what is found there; each array of shape (n,).

    Attributes:
        y: In the door frame [m].
        z: In the door frame [m].
        albedo: Share of light that comes back.
        tilt_y: Slope of the normal along y.
        tilt_z: Slope of the normal along z.
        gloss: Share of light that shines.
        open: Share of light that gets in: below 1 in grooves.
        cover: 1 where the door or what sticks to it hides what is behind.
        mark: Number of what is there; rays are closer where it changes.
        sharp: Over which length an outline may change, so that rays share it evenly [m].
    """

    y: Array
    z: Array
    albedo: Array
    tilt_y: Array
    tilt_z: Array
    gloss: Array
    open: Array
    cover: Array
    mark: Array
    sharp: float

    def paint(self, where: Array, albedo: Array | float, number: float, gloss: float = 0.0) -> None:
        """Cover the places that lie in a boolean mask, shape (n,), with something opaque."""
        self.albedo = np.where(where, albedo, self.albedo)
        self.gloss = np.where(where, gloss, self.gloss)
        self.mark = np.where(where, number, self.mark)

    def step(self, inside: Array) -> Array:
        """How much of a ray is inside a border, from its signed distance [m]: 0 to 1."""
        found: Array = np.clip(0.5 + inside / self.sharp, 0.0, 1.0)
        return found


class Mark(Protocol):
    """Something that was done to the face or sticks to it."""

    def on(self, patch: Patch) -> None:
        """Change the patch."""


def outline(y: Array, z: Array, sharp: float) -> Array:
    """How much of a ray is on the sound door: 0 to 1, shape (n,)."""
    found: Array = np.clip(0.5 + y / sharp, 0.0, 1.0) * np.clip(0.5 + z / sharp, 0.0, 1.0)
    return found


@dataclass(frozen=True, eq=False)
class Face:
    """The face as the camera sees it; its outline is y = 0 and z = 0 in its plane.

    The arris is taken as far proud of y = 0 and z = 0 as its depth needs so that these are what the camera sees.
    """

    place: Place
    finish: Finish
    marks: Sequence[Mark]

    def near(self, rays: Rays, margin: float) -> Array:
        """Which rays may meet it, shape (n,) of bool."""
        y, z = rays.at(0.0)
        found: Array = (y > -margin - 4e-3) & (z > -margin - 4e-3)
        return found

    def look(self, rays: Rays, light: Light) -> tuple[Array, Array, Array]:
        """Radiance, cover and number of what each ray meets, shapes (n,)."""
        y, z = rays.at(0.0)
        zero = np.zeros_like(y)
        sharp = self.place.pixel / SIDE * 2.0
        patch = Patch(
            y,
            z,
            self.finish.at(y, z),
            zero,
            zero,
            zero + self.finish.gloss,
            zero + 1.0,
            outline(y, z, sharp),
            zero,
            sharp,
        )
        for mark in self.marks:
            mark.on(patch)
        size = 1.0 / np.sqrt(1.0 + patch.tilt_y**2 + patch.tilt_z**2)
        normal = (-size, patch.tilt_y * size, patch.tilt_z * size)
        diffuse, shine = light.on((zero, y, z), normal, patch.gloss, rays.centre, behind=False)
        radiance = (patch.albedo * diffuse + shine) * patch.open
        return radiance, patch.cover, np.where(patch.cover > 0.5, patch.mark, NO_MARK)
