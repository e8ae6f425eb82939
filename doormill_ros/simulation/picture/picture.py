"""Renders the picture that the camera takes of a door that stands where the scene says.

The scene is evaluated once per pixel far from the door's edges and on a finer grid along
them, spread by the lens, collected by pixel areas and exposed with noise.
"""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.simulation.picture.optics import Block, bin_down, expose, project, rays, spread
from doormill_ros.simulation.picture.outline import EdgeProfile
from doormill_ros.simulation.picture.scene import PictureScene, Shadow, Surface
from doormill_ros.simulation.picture.texture import Texture

FINE = 3  # sub-pixels per pixel along the door's edges
_STREAK = 40.0  # a streak of grain is that many times longer than wide
_SUB_BITS = 4  # fractional bits of polygon corners
_CHORD = 2.0e-3  # longest side of a polygon drawn straight, for the lens bends longer ones [m]


def _textures(rng: np.random.Generator, surface: Surface) -> list[Texture]:
    out = []
    if surface.mottle:
        out.append(Texture(rng, surface.mottle, surface.mottle_size, surface.mottle_size))
    if surface.grain:
        width = surface.grain_width
        out.append(Texture(rng, surface.grain, width, _STREAK * width, surface.grain_angle))
    return out


def _chords(outline: FloatArray) -> FloatArray:
    """An outline (n, 2) [m] with points (m, 2) on its sides, so close that the lens leaves it straight."""
    ends = np.roll(outline, -1, axis=0)
    pieces = np.maximum(np.ceil(np.hypot(*(ends - outline).T) / _CHORD), 1.0).astype(int)
    sides = zip(outline, ends, pieces, strict=True)
    return np.concatenate([np.linspace(start, end, many, endpoint=False) for start, end, many in sides])


class _Painter:
    """The scene's random fields, drawn once, and the radiance along any rays."""

    def __init__(self, scene: PictureScene, rng: np.random.Generator) -> None:
        self.scene = scene
        self.hinge = EdgeProfile(rng, scene.edges, "hinge")
        self.bottom = EdgeProfile(rng, scene.edges, "bottom")
        self.textures = {name: _textures(rng, getattr(scene, name)) for name in ("face", "background")}
        self.band_phase = rng.uniform(0, 2 * np.pi)
        self.turn = np.cos(scene.offset.rotation), np.sin(scene.offset.rotation)

    def door_coordinates(
        self, ray_x: Float32Array, ray_y: Float32Array, setback: float = 0.0
    ) -> tuple[Float32Array, Float32Array]:
        """Door y and z [m] where rays meet the plane `setback` [m] behind the face; all of one shape (n, m)."""
        away = np.float32(-(self.scene.distance + setback))
        corner, (c, s) = self.scene.corner, self.turn
        y = (away * np.float32(c)) * ray_x + (away * np.float32(s)) * ray_y
        z = (away * np.float32(c)) * ray_y - (away * np.float32(s)) * ray_x
        y -= np.float32(c * corner[0] + s * corner[1])
        z -= np.float32(c * corner[1] - s * corner[0])
        return y, z

    def pixels(self, points: FloatArray) -> FloatArray:
        """Pixels u, v (n, 2) of points y, z (n, 2) [m] of the face plane, door axes."""
        (c, s), corner = self.turn, self.scene.corner
        across = corner[0] + c * points[:, 0] - s * points[:, 1]
        up = corner[1] + s * points[:, 0] + c * points[:, 1]
        return project(self.scene.camera, self.scene.distance, across, up)

    def cover(self, y: Float32Array, z: Float32Array, sample: float, rough: bool) -> Float32Array:
        """Share of each sub-pixel of size `sample` [m] that the face covers; door y, z [m] and it are (n, m)."""
        tilt = np.float32(np.tan(self.scene.edges.squareness))
        depth, height = y, z - tilt * y
        if rough:
            depth, height = depth - self.hinge(z), height - self.bottom(y)
        # A fibrous rim thins out over its width; a sharp one over a sub-pixel.
        scale = np.float32(1.0 / np.hypot(sample, 2.0 * self.scene.edges.softness))
        share: Float32Array = np.clip(depth * scale + 0.5, 0, 1) * np.clip(height * scale + 0.5, 0, 1)
        return share

    def albedo(self, name: str, y: Float32Array, z: Float32Array) -> Float32Array:
        """Brightness of a surface under unit light at door y, z [m]; all of one shape (n, m)."""
        out = np.full(y.shape, 1.0, dtype=np.float32)
        for texture in self.textures[name]:
            out += texture(y, z)
        out *= np.float32(getattr(self.scene, name).brightness)
        brightness: Float32Array = cv2.max(out, 0.0)
        return brightness

    def _shade(self, out: Float32Array, shadows: list[Shadow], y: Float32Array, z: Float32Array) -> None:
        for shadow in shadows:
            c, s = np.cos(shadow.angle), np.sin(shadow.angle)
            far = (
                np.float32(c) * y + np.float32(s) * z - np.float32(c * shadow.place[0] + s * shadow.place[1])
            )
            share = np.clip(far / np.float32(shadow.penumbra) + 0.5, 0, 1)
            out *= 1 + np.float32(shadow.factor - 1) * share * share * (3 - 2 * share)

    def _stripe(self, out: Float32Array, y: Float32Array, z: Float32Array) -> None:
        for strip in self.scene.strips:
            across, along = (y, z) if strip.edge == "hinge" else (z, y)
            steep = np.float32(1.0 / strip.blur)
            inside = np.clip((across - np.float32(strip.start)) * steep + 0.5, 0, 1)
            inside *= np.clip((np.float32(strip.stop) - across) * steep + 0.5, 0, 1)
            inside *= (along >= np.float32(strip.first)) & (along <= np.float32(strip.last))
            out *= 1 + np.float32(strip.factor - 1) * inside

    def light(self, ray_x: Float32Array, ray_y: Float32Array) -> Float32Array:
        """Light that falls on what rays x/z, y/z see, shadows aside; all of one shape (n, m)."""
        light = self.scene.light
        out = 1 + np.float32(light.gradient[0] / 0.55) * ray_x + np.float32(light.gradient[1] / 0.31) * ray_y
        if light.vignetting:
            out *= 1 - np.float32(light.vignetting / 0.4) * (ray_x * ray_x + ray_y * ray_y)
        if light.banding:
            out *= 1 + np.float32(light.banding) * np.sin(
                np.float32(35.0) * ray_y + np.float32(self.band_phase)
            )
        fallen: Float32Array = np.float32(light.level) * cv2.max(out, 0.0)
        return fallen

    def paint(self, radiance: Float32Array, block: Block, fine: int, behind: bool) -> None:
        """Fill the blots that lie on the background, or those before the door, into `radiance`."""
        for blot in self.scene.blots:
            if blot.behind is behind:
                at = self.pixels(_chords(blot.outline))
                at = (at - [block[2] - 0.5, block[0] - 0.5]) * fine - 0.5
                if np.all(at.max(axis=0) > 0) and np.all(at.min(axis=0) < radiance.shape[::-1]):
                    corners = np.rint(at * 2**_SUB_BITS).astype(np.int32)
                    cv2.fillPoly(radiance, [corners], float(blot.brightness), cv2.LINE_8, _SUB_BITS)

    def _mark(self, out: Float32Array, ray_x: Float32Array, ray_y: Float32Array, fine: int) -> None:
        """Put the cell's dots before the background; all of one shape (n, m)."""
        marks, camera = self.scene.camera.marks, self.scene.camera
        if marks is None:
            return
        ahead = marks.x - float(camera.origin[0])
        steep = np.float32(fine * float(camera.matrix[0, 0]) / ahead)
        for across, up in marks.places:
            y = np.float32(-ahead) * ray_x - np.float32(across - camera.origin[1])
            z = np.float32(-ahead) * ray_y - np.float32(up - camera.origin[2])
            away = cv2.magnitude(y, z)
            for radius, brightness in ((2 * marks.radius, marks.black), (marks.radius, marks.white)):
                share = np.clip((np.float32(radius) - away) * steep + np.float32(0.5), 0, 1)
                out += (np.float32(brightness) - out) * share

    def radiance(self, block: Block, fine: int) -> Float32Array:
        """What the sub-pixels of a block see, before the lens spreads it; (rows * fine, columns * fine)."""
        scene, shadows = self.scene, self.scene.light.shadows
        ray_x, ray_y = rays(scene.camera, block, fine)
        y, z = self.door_coordinates(ray_x, ray_y)
        out = self.albedo("background", y, z)
        self.paint(out, block, fine, behind=True)
        self._mark(out, ray_x, ray_y, fine)
        self._shade(out, [s for s in shadows if s.behind], y, z)
        if scene.door:
            self._put_door(out, (ray_x, ray_y), (y, z), fine)
        self.paint(out, block, fine, behind=False)
        out *= self.light(ray_x, ray_y)
        return out

    def _put_door(
        self,
        out: Float32Array,
        seen: tuple[Float32Array, Float32Array],
        at: tuple[Float32Array, Float32Array],
        fine: int,
    ) -> None:
        """Put the door before what is behind it: by rays x/z, y/z that see door y, z [m]; all of one shape (n, m)."""
        scene, (y, z) = self.scene, at
        sample = scene.distance / float(scene.camera.matrix[0, 0]) / fine
        face = self.albedo("face", y, z)
        self._stripe(face, y, z)
        self._shade(face, [s for s in scene.light.shadows if s.on_face], y, z)
        if scene.back_edge is not None:
            lip = scene.back_edge
            back_y, back_z = self.door_coordinates(*seen, lip.setback)
            share = np.clip((back_y + np.float32(lip.hinge)) / np.float32(sample) + 0.5, 0, 1)
            share *= np.clip((back_z + np.float32(lip.bottom)) / np.float32(sample) + 0.5, 0, 1)
            out += (face * np.float32(lip.brightness) - out) * share
        out += (face - out) * self.cover(y, z, sample, rough=fine > 1)

    def edge_blocks(self, margin: int) -> list[Block]:
        """Blocks of the picture that hold the hinge edge and the bottom edge."""
        rows, columns = self.scene.camera.shape
        along = np.linspace(-1.0e-3, 0.22, 60)
        blocks = []
        for name, outline in (("hinge", self.hinge), ("bottom", self.bottom)):
            rim = 3 * self.scene.edges.roughness + 2 * self.scene.edges.softness
            sides = [np.full_like(along, -rim), np.full_like(along, outline.deepest + rim)]
            strips = [np.column_stack([s, along] if name == "hinge" else [along, s]) for s in sides]
            at = self.pixels(np.vstack(strips))
            seen = at[np.all((at > -margin) & (at < [columns + margin, rows + margin]), axis=1)]
            if len(seen):
                low, high = np.floor(seen.min(axis=0)).astype(int), np.ceil(seen.max(axis=0)).astype(int)
                column0, row0 = np.maximum(low - margin, 0)
                column1, row1 = np.minimum(high + margin + 1, [columns, rows])
                # The nodes are far apart: an edge that leaves the picture does so at its border.
                row0, column0 = (0, column0) if name == "hinge" else (row0, 0)
                blocks.append((int(row0), int(row1), int(column0), int(column1)))
        return [b for b in blocks if b[1] > b[0] and b[3] > b[2]]


def exposure(scene: PictureScene, rng: np.random.Generator) -> Float32Array:
    """Light that each pixel collects, shape (rows, columns)."""
    painter = _Painter(scene, rng)
    rows, columns = scene.camera.shape
    picture = spread(painter.radiance((0, rows, 0, columns), 1), scene.sensor, 1)
    reach = int(np.ceil(4 * scene.sensor.blur + scene.sensor.defocus)) + 2
    for block in painter.edge_blocks(2 * reach + 4):
        fine = bin_down(spread(painter.radiance(block, FINE), scene.sensor, FINE), FINE)
        # The rim of a block lacks the light of its neighbours; it stays as it was.
        row0, row1, column0, column1 = block
        top, left = (0 if row0 == 0 else reach), (0 if column0 == 0 else reach)
        low, right = (0 if row1 == rows else reach), (0 if column1 == columns else reach)
        picture[row0 + top : row1 - low, column0 + left : column1 - right] = fine[
            top : fine.shape[0] - low, left : fine.shape[1] - right
        ]
    return picture


def render_picture(scene: PictureScene, seed: int) -> ByteArray:
    """The grey picture of a scene, shape (rows, columns).

    Args:
        scene: What is seen, with the true pose.
        seed: Of every random field and of the noise; equal seeds give equal pictures.
    """
    rng = np.random.default_rng(seed)
    return expose(exposure(scene, rng), scene.sensor, rng)
