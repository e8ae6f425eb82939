"""Boxes and rods beside, behind or before the door."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from support.views.finish import Finish
from support.views.light import Light, Rod
from support.views.optics import Array, Rays

NOTHING = -1.0


@dataclass(frozen=True, eq=False)
class Box:
    """A box turned about the door's x axis.

    Attributes:
        middle: Of the box, door frame [m].
        half: Half its sides along its own axes [m].
        turn: Of its own axes about door x [rad].
        finish: Of its sides, read along its own axes.
        fine: Whether every ray is followed closely.
    """

    middle: tuple[float, float, float]
    half: tuple[float, float, float]
    finish: Finish
    turn: float = 0.0
    fine: bool = False

    @property
    def front(self) -> float:
        """x of what is next to the camera [m]."""
        return self.middle[0] - self.half[0]

    def _meet(self, rays: Rays, margin: float) -> tuple[Array, Array, Array, list[Array]]:
        c, s = np.float32(math.cos(self.turn)), np.float32(math.sin(self.turn))
        way = [np.ones_like(rays.a), c * rays.a + s * rays.b, c * rays.b - s * rays.a]
        start = rays.centre - np.asarray(self.middle)
        start = np.array([start[0], c * start[1] + s * start[2], c * start[2] - s * start[1]])
        enter, leave = np.full_like(rays.a, 1e-6), np.full_like(rays.a, 1e6)
        side = np.zeros_like(rays.a)
        for i in range(3):
            step = np.where(np.abs(way[i]) < 1e-7, 1e-7, way[i])
            one = (-self.half[i] - margin - start[i]) / step
            two = (self.half[i] + margin - start[i]) / step
            first = np.minimum(one, two)
            side = np.where(first > enter, float(i), side)
            enter = np.maximum(enter, first)
            leave = np.minimum(leave, np.maximum(one, two))
        own = [np.float32(start[i]) + enter * way[i] for i in range(3)]
        return leave > enter, enter, side, own

    def near(self, rays: Rays, margin: float) -> Array:
        """Which rays may meet it, shape (n,) of bool."""
        return self._meet(rays, margin)[0]

    def look(self, rays: Rays, light: Light) -> tuple[Array, Array, Array]:
        """Radiance, cover and number of what each ray meets, shapes (n,)."""
        hit, s, side, own = self._meet(rays, 0.0)
        s = np.where(hit, s, 0.1)
        points = tuple(np.float32(rays.centre[i]) + s * w for i, w in enumerate((1.0, rays.a, rays.b)))
        sign = [np.sign(o) for o in own]
        c, turned = math.cos(self.turn), math.sin(self.turn)
        n_y, n_z = np.where(side == 1, sign[1], 0.0), np.where(side == 2, sign[2], 0.0)
        normal = (np.where(side == 0, -1.0, 0.0), c * n_y - turned * n_z, turned * n_y + c * n_z)
        u = np.where(side == 1, own[0], own[1])
        v = np.where(side == 2, own[0], own[2])
        diffuse, shine = light.on(
            (points[0], points[1], points[2]), normal, self.finish.gloss, rays.centre, self.front > 0.0
        )
        radiance = self.finish.at(u, v) * diffuse + shine
        return radiance, hit.astype(np.float32), np.where(hit, side, NOTHING)


@dataclass(frozen=True, eq=False)
class Bar:
    """A round bar, cable, hair or thread.

    Attributes:
        rod: Its shape.
        albedo: Share of light that comes back.
        gloss: Share of light that shines.
        fine: Whether every ray is followed closely, for what is no thicker than a pixel.
    """

    rod: Rod
    albedo: float
    gloss: float = 0.0
    fine: bool = False

    @property
    def front(self) -> float:
        """x of what is next to the camera [m]."""
        return min(self.rod.start[0], self.rod.end[0])

    def _meet(self, rays: Rays, margin: float) -> tuple[Array, Array, Array]:
        start, end = np.asarray(self.rod.start), np.asarray(self.rod.end)
        length = float(np.linalg.norm(end - start))
        axis = (end - start) / length
        radius = self.rod.radius + margin
        way = (np.ones_like(rays.a), rays.a, rays.b)
        square = 1.0 + rays.a**2 + rays.b**2
        along = sum(way[i] * np.float32(axis[i]) for i in range(3))
        from_start = rays.centre - start
        on_axis = float(from_start @ axis)
        dot = sum(way[i] * np.float32(from_start[i]) for i in range(3))
        a = square - along**2
        b = dot - along * on_axis
        c = float(from_start @ from_start) - on_axis**2 - radius**2
        root = b * b - a * c
        s = (-b - np.sqrt(np.maximum(root, 0.0))) / np.maximum(a, 1e-9)
        place = on_axis + s * along
        return (root > 0.0) & (place > -margin) & (place < length + margin) & (s > 0.0), s, place

    def near(self, rays: Rays, margin: float) -> Array:
        """Which rays may meet it, shape (n,) of bool."""
        return self._meet(rays, margin)[0]

    def look(self, rays: Rays, light: Light) -> tuple[Array, Array, Array]:
        """Radiance, cover and number of what each ray meets, shapes (n,)."""
        hit, s, place = self._meet(rays, 0.0)
        s, place = np.where(hit, s, 0.1), np.where(hit, place, 0.0)
        start, end = np.asarray(self.rod.start), np.asarray(self.rod.end)
        axis = (end - start) / float(np.linalg.norm(end - start))
        points = tuple(np.float32(rays.centre[i]) + s * w for i, w in enumerate((1.0, rays.a, rays.b)))
        normal = tuple(
            (points[i] - np.float32(start[i]) - place * np.float32(axis[i])) / self.rod.radius
            for i in range(3)
        )
        diffuse, shine = light.on(
            (points[0], points[1], points[2]),
            (normal[0], normal[1], normal[2]),
            self.gloss,
            rays.centre,
            self.front > 0.0,
        )
        return self.albedo * diffuse + shine, hit.astype(np.float32), np.where(hit, 0.0, NOTHING)
