"""Renders the picture that the camera takes of a door that stands where the scene says.

The scene is evaluated once per pixel far from the door's edges and on a finer grid along
them, spread by the lens, collected by pixel areas and exposed with noise.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.simulation.picture_optics import bin_down, expose, rays, spread
from doormill_ros.simulation.picture_scene import PictureScene, Surface
from doormill_ros.simulation.picture_texture import Wander, look_up, tile

FINE = 3  # sub-pixels per pixel along the door's edges
_STREAK = 40.0  # a streak of grain is that many times longer than wide
_SAMPLES = 4.0  # texture samples per correlation length


class _Painter:
    """The scene's random fields, drawn once, and the radiance along any rays."""

    def __init__(self, scene: PictureScene, rng: np.random.Generator) -> None:
        self.scene = scene
        edges = scene.edges
        self.hinge = Wander(rng, edges.roughness, edges.correlation, -0.1, 0.3)
        self.bottom = Wander(rng, edges.roughness, edges.correlation, -0.1, 0.3)
        self.fields = {name: self._fields(getattr(scene, name), rng) for name in ("face", "background")}
        layout = scene.layout
        self.distance = layout.rear_face_x - scene.thickness - scene.camera.origin[0]
        hinge_edge = layout.centre_y - scene.width / 2.0
        # The nominal corner seen from the camera, along base y and z.
        self.corner = (
            hinge_edge + scene.offset.y - (scene.camera.origin[1] - scene.width / 2.0),
            layout.bottom_z + scene.offset.z - scene.camera.origin[2],
        )

    @staticmethod
    def _fields(surface: Surface, rng: np.random.Generator) -> tuple:
        mottle = tile(rng, _SAMPLES, _SAMPLES) if surface.mottle else None
        grain = tile(rng, _SAMPLES, _SAMPLES) if surface.grain else None
        return mottle, grain

    def door_coordinates(self, ray_x: np.ndarray, ray_y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Door y and z [m] where rays meet the plane of the face."""
        across = np.float32(-self.distance) * ray_x - np.float32(self.corner[0])
        up = np.float32(-self.distance) * ray_y - np.float32(self.corner[1])
        c, s = np.float32(np.cos(self.scene.offset.rotation)), np.float32(np.sin(self.scene.offset.rotation))
        return c * across + s * up, c * up - s * across

    def inside(self, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance [m] of door points from the hinge edge and the bottom edge, inside positive."""
        angle = self.scene.edges.squareness
        along, above = y * np.cos(angle) + z * np.sin(angle), z * np.cos(angle) - y * np.sin(angle)
        return y - self.hinge(z), above - self.bottom(along)

    def albedo(self, name: str, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Brightness of a surface at door coordinates, under unit light."""
        surface: Surface = getattr(self.scene, name)
        mottle, grain = self.fields[name]
        out = np.full(y.shape, surface.brightness, dtype=np.float32)
        if mottle is not None:
            scale = np.float32(_SAMPLES / surface.mottle_size)
            out *= 1 + np.float32(surface.mottle) * look_up(mottle, y * scale, z * scale)
        if grain is not None:
            scale = np.float32(_SAMPLES / surface.grain_width)
            c, s = np.float32(np.cos(surface.grain_angle)), np.float32(np.sin(surface.grain_angle))
            across, along = (y * c - z * s) * scale, (z * c + y * s) * (scale / np.float32(_STREAK))
            out *= 1 + np.float32(surface.grain) * look_up(grain, across, along)
        return np.maximum(out, 0)

    def light(self, ray_x: np.ndarray, ray_y: np.ndarray) -> np.ndarray:
        """Light that falls on what a ray sees."""
        light = self.scene.light
        out = 1 + np.float32(light.gradient[0] / 0.55) * ray_x + np.float32(light.gradient[1] / 0.31) * ray_y
        out *= 1 - np.float32(light.vignetting / 0.4) * (ray_x * ray_x + ray_y * ray_y)
        return np.float32(light.level) * np.maximum(out, 0)

    def radiance(self, block: tuple[int, int, int, int], fine: int) -> np.ndarray:
        """What the sub-pixels of a block see, before the lens spreads it; float32."""
        ray_x, ray_y = rays(self.scene.camera, block, fine)
        y, z = self.door_coordinates(ray_x, ray_y)
        hinge, bottom = self.inside(y, z)
        per_sample = np.float32(self.scene.camera.matrix[0, 0] / self.distance * fine)
        cover = np.clip(hinge * per_sample + 0.5, 0, 1) * np.clip(bottom * per_sample + 0.5, 0, 1)
        face, behind = self.albedo("face", y, z), self.albedo("background", y, z)
        return ((behind + (face - behind) * cover) * self.light(ray_x, ray_y)).astype(np.float32)

    def edge_blocks(self, margin: int) -> list[tuple[int, int, int, int]]:
        """Blocks of the picture that hold the hinge edge and the bottom edge."""
        rows, columns = self.scene.camera.shape
        y, z = self.door_coordinates(*rays(self.scene.camera, (0, rows, 0, columns), 1))
        across = np.flatnonzero((np.abs(y[::8]) < 0.6e-3).any(axis=0))
        down = np.flatnonzero((np.abs(z[:, ::8]) < 0.6e-3).any(axis=1))
        blocks = []
        if across.size:
            blocks.append((0, rows, max(across[0] - margin, 0), min(across[-1] + margin, columns)))
        if down.size:
            blocks.append((max(down[0] - margin, 0), min(down[-1] + margin, rows), 0, columns))
        return blocks


def render_picture(scene: PictureScene, seed: int) -> np.ndarray:
    """The grey picture of a scene, uint8, shape (rows, columns).

    Args:
        scene: What is seen, with the true pose.
        seed: Of every random field and of the noise; equal seeds give equal pictures.
    """
    rng = np.random.default_rng(seed)
    painter = _Painter(scene, rng)
    rows, columns = scene.camera.shape
    picture = spread(painter.radiance((0, rows, 0, columns), 1), scene.sensor, 1)
    reach = int(np.ceil(4 * scene.sensor.blur + scene.sensor.defocus)) + 2
    for block in painter.edge_blocks(2 * reach + 8):
        fine = bin_down(spread(painter.radiance(block, FINE), scene.sensor, FINE), FINE)
        # The rim of a block lacks the light of its neighbours; it stays as it was.
        row0, row1, column0, column1 = block
        top, left = (0 if row0 == 0 else reach), (0 if column0 == 0 else reach)
        low, right = (0 if row1 == rows else reach), (0 if column1 == columns else reach)
        picture[row0 + top : row1 - low, column0 + left : column1 - right] = fine[
            top : fine.shape[0] - low, left : fine.shape[1] - right
        ]
    return expose(picture, scene.sensor, rng)
