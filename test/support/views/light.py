"""Lamps of some size, and what stands between them and what they light."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from support.views.noise import smooth
from support.views.optics import Array

Points = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Rod:
    """A round bar or cable from one end to the other, door frame [m]."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float

    def hides(self, points: Points, lamp: Lamp) -> Array:
        """Share of the lamp that points, shape (n,) each, do not see for this rod."""
        axis = np.subtract(self.end, self.start)
        length = float(np.linalg.norm(axis))
        axis = axis / length
        to_lamp = [np.float32(lamp.place[i]) - points[i] for i in range(3)]
        from_start = [points[i] - np.float32(self.start[i]) for i in range(3)]
        far = np.sqrt(sum(d * d for d in to_lamp))
        way = [d / far for d in to_lamp]
        along = sum(way[i] * np.float32(axis[i]) for i in range(3))
        e = sum(from_start[i] * way[i] for i in range(3))
        f = sum(from_start[i] * np.float32(axis[i]) for i in range(3))
        even = np.maximum(1.0 - along * along, 1e-6)
        on_rod = np.clip((f - along * e) / even, 0.0, length)
        on_way = np.clip(along * on_rod - e, 0.0, far)
        gap = np.sqrt(
            sum((from_start[i] + way[i] * on_way - np.float32(axis[i]) * on_rod) ** 2 for i in range(3))
        )
        half = np.maximum(lamp.radius * on_way / far, 1e-6)
        found: Array = smooth((self.radius + half - gap) / (2.0 * half)) * np.minimum(1.0, self.radius / half)
        return np.where(on_way > 0.0, found, 0.0)


@dataclass(frozen=True)
class Screen:
    """A flat board of which a straight border casts a shadow: all of the plane x where n . (y, z) > c, door frame.

    Attributes:
        x: Of its plane [m].
        normal: Unit vector (y, z) towards the inside of the board.
        border: c [m].
        reach: How far the board goes from its border [m].
    """

    x: float
    normal: tuple[float, float]
    border: float
    reach: float = 1.0

    def hides(self, points: Points, lamp: Lamp) -> Array:
        """Share of the lamp that points, shape (n,) each, do not see for this board."""
        share = (self.x - points[0]) / (lamp.place[0] - points[0])
        y = points[1] + share * (lamp.place[1] - points[1])
        z = points[2] + share * (lamp.place[2] - points[2])
        inside = self.normal[0] * y + self.normal[1] * z - self.border
        half = np.maximum(lamp.radius * np.abs(share), 1e-6)
        found: Array = smooth(0.5 + inside / (2.0 * half)) * smooth(
            0.5 + (self.reach - inside) / (2.0 * half)
        )
        return np.where((share > 0.0) & (share < 1.0), found, 0.0)


@dataclass(frozen=True)
class Leaf:
    """The door itself between a lamp and what stands behind it; thickness and proud lip are of its body [m]."""

    thickness: float

    def hides(self, points: Points, lamp: Lamp) -> Array:
        """Share of the lamp that points behind the door, shape (n,) each, do not see."""
        depths = []
        for x in (0.0, self.thickness):
            share = (x - points[0]) / (lamp.place[0] - points[0])
            y = points[1] + share * (lamp.place[1] - points[1])
            z = points[2] + share * (lamp.place[2] - points[2])
            depths.append((y, z, share))
        (y0, z0, share), (y1, z1, _) = depths
        # The deepest point of the ray in the quarter y > 0, z > 0 is at an end or where both are as deep.
        slope = (y1 - z1) - (y0 - z0)
        t = np.clip(-(y0 - z0) / np.where(np.abs(slope) < 1e-9, 1e-9, slope), 0.0, 1.0)
        middle = np.minimum(y0 + t * (y1 - y0), z0 + t * (z1 - z0))
        inside = np.maximum(np.maximum(np.minimum(y0, z0), np.minimum(y1, z1)), middle)
        half = np.maximum(lamp.radius * np.abs(share), 1e-6)
        found: Array = smooth(0.5 + inside / (2.0 * half))
        return np.where(points[0] > self.thickness - 1e-6, found, 0.0)


@dataclass(frozen=True)
class Window:
    """An opening in the plane x through which a lamp shines: y and z of its middle and half sides [m]."""

    x: float
    middle: tuple[float, float]
    half: tuple[float, float]
    turn: float = 0.0

    def lets(self, points: Points, lamp: Lamp) -> Array:
        """Share of the lamp that points, shape (n,) each, see through the opening."""
        share = (self.x - points[0]) / (lamp.place[0] - points[0])
        y = points[1] + share * (lamp.place[1] - points[1]) - self.middle[0]
        z = points[2] + share * (lamp.place[2] - points[2]) - self.middle[1]
        c, s = np.cos(self.turn), np.sin(self.turn)
        soft = np.maximum(2.0 * lamp.radius * np.abs(share), 1e-6)
        across = smooth(0.5 + (self.half[0] - np.abs(c * y + s * z)) / soft)
        along = smooth(0.5 + (self.half[1] - np.abs(c * z - s * y)) / soft)
        found: Array = across * along
        return found


@dataclass(frozen=True)
class Lamp:
    """A round lamp.

    Attributes:
        place: Its middle, door frame [m].
        power: Irradiance that it gives the face at the corner where it shines straight on it.
        radius: Of the lamp [m]; soft borders of shadows come from it.
        window: What it shines through.
    """

    place: tuple[float, float, float]
    power: float
    radius: float
    window: Window | None = None


@dataclass(frozen=True)
class Light:
    """All lamps, the light from everywhere, and what casts shadows."""

    lamps: tuple[Lamp, ...]
    ambient: float
    shades: tuple[Rod | Screen | Leaf, ...] = field(default=())

    def on(
        self, points: Points, normal: Points, gloss: Array | float, eye: Array, behind: bool
    ) -> tuple[Array, Array]:
        """Diffuse irradiance and the shine towards the eye, shapes (n,).

        Args:
            points: x, y, z, shapes (n,) [m].
            normal: Unit normals, shapes (n,) or scalars.
            gloss: Share of light that shines; 0 for matt.
            eye: Projection centre, shape (3,) [m].
            behind: Whether the door may cast its shadow on the points.
        """
        diffuse = np.full(points[1].shape, self.ambient, dtype=np.float32)
        shine = np.zeros(points[1].shape, dtype=np.float32)
        glossy = bool(np.any(np.asarray(gloss) > 0.0))
        if glossy:
            towards = [np.float32(eye[i]) - points[i] for i in range(3)]
            near = 1.0 / np.sqrt(towards[0] ** 2 + towards[1] ** 2 + towards[2] ** 2)
        for lamp in self.lamps:
            way = [np.float32(lamp.place[i]) - points[i] for i in range(3)]
            square = way[0] ** 2 + way[1] ** 2 + way[2] ** 2
            inverse = 1.0 / np.sqrt(square)
            cosine = np.maximum((normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2]) * inverse, 0.0)
            reference = np.float32(sum(p * p for p in lamp.place))
            arriving = np.float32(lamp.power) * reference / square
            for shade in self.shades:
                if behind or not isinstance(shade, Leaf):
                    arriving = arriving * (1.0 - shade.hides(points, lamp))
            if lamp.window is not None:
                arriving = arriving * lamp.window.lets(points, lamp)
            diffuse += cosine * arriving
            if glossy:
                half = [way[i] * inverse + towards[i] * near for i in range(3)]
                size = 1.0 / np.sqrt(half[0] ** 2 + half[1] ** 2 + half[2] ** 2)
                up = np.maximum((half[0] * normal[0] + half[1] * normal[1] + half[2] * normal[2]) * size, 0.0)
                up = np.minimum(up, 1.0)
                for _ in range(5):  # to the 32nd power
                    up = up * up
                shine += up * arriving * gloss
        return diffuse, shine
