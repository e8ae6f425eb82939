"""What plain OpenCV makes of the door's corner: Canny + Hough, and the line segment detector.

Both get the undistorted picture, know where each edge may lie and see only those strips, and
turn pixels into metres exactly as the localiser does.
"""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.units import DEG, MM

REACH, TURN = 13 * MM, 2.5 * DEG


class Strips:
    """Undistorted strips of a picture about the nominal edges, and the way back to metres."""

    def __init__(self, camera: CameraModel, view: FaceView) -> None:
        """Prepare the maps for one door size."""
        self.view = view
        self.k = camera.k
        ideal = {edge: self._ideal(view, edge) for edge in (HINGE, BOTTOM)}
        self.boxes, self.maps = {}, {}
        for edge, points in ideal.items():
            low = np.clip(np.floor(points.min(axis=0)).astype(int), 0, np.array(camera.size) - 1)
            high = np.clip(np.ceil(points.max(axis=0)).astype(int), 0, np.array(camera.size) - 1)
            shifted = camera.k.copy()
            shifted[:2, 2] -= low
            self.boxes[edge] = low
            size = tuple(int(v) for v in high - low)
            self.maps[edge] = cv2.initUndistortRectifyMap(
                camera.k, camera.distortion, None, shifted, size, cv2.CV_16SC2
            )

    def _ideal(self, view: FaceView, edge: str) -> np.ndarray:
        """Undistorted pixels of the corners of the strip in which an edge may lie."""
        far = view.length(edge) + 0.01
        corners = np.array([[-1, 0], [1, 0], [-1, 1], [1, 1]]) * [REACH, far] + [0, -REACH * 0]
        corners = corners if edge == HINGE else corners[:, ::-1]
        rays = view.camera.undistort(view.pixels(corners))
        return rays * [self.k[0, 0], self.k[1, 1]] + [self.k[0, 2], self.k[1, 2]]

    def cut(self, picture: np.ndarray, edge: str) -> np.ndarray:
        """The strip of one edge."""
        return cv2.remap(picture, *self.maps[edge], cv2.INTER_LINEAR)

    def metres(self, edge: str, pixels: np.ndarray) -> np.ndarray:
        """Face points (n, 2) [m] of pixels (n, 2) of a strip."""
        rays = (pixels + self.boxes[edge] - [self.k[0, 2], self.k[1, 2]]) / [self.k[0, 0], self.k[1, 1]]
        return self.view.points(self.view.camera.distort(rays))


def corner(hinge: np.ndarray, bottom: np.ndarray) -> np.ndarray:
    """Pose y, z [m], rotation [rad] of two lines given by two face points each, (2, 2); rotation of the bottom."""
    p = (hinge[1, 0] - hinge[0, 0]) / (hinge[1, 1] - hinge[0, 1])
    q = (bottom[1, 1] - bottom[0, 1]) / (bottom[1, 0] - bottom[0, 0])
    a, b = hinge[0, 0] - p * hinge[0, 1], bottom[0, 1] - q * bottom[0, 0]
    y = (a + p * b) / (1 - p * q)
    return np.array([y, b + q * y, np.arctan(q)])


def canny_hough(picture: np.ndarray, strips: Strips) -> np.ndarray | None:
    """The strongest line of each strip, intersected; None when there is none."""
    lines = []
    for edge, middle in ((HINGE, 0.0), (BOTTOM, np.pi / 2)):
        strip = strips.cut(picture, edge)
        level = float(np.median(strip))
        edges = cv2.Canny(cv2.GaussianBlur(strip, (5, 5), 0), 0.33 * level, 0.66 * level)
        low = np.pi - TURN if edge == HINGE else middle - TURN
        found = cv2.HoughLines(edges, 1, 0.05 * DEG, 100, min_theta=low, max_theta=low + 2 * TURN)
        if edge == HINGE:  # theta and theta + pi are the same line; one call cannot reach over the seam
            other = cv2.HoughLines(edges, 1, 0.05 * DEG, 100, min_theta=0, max_theta=TURN)
            found = _stronger(edges, found, other)
        if found is None:
            return None
        rho, theta = np.ravel(found)[:2]
        c, s = np.cos(theta), np.sin(theta)
        far = float(max(strip.shape))
        ends = np.array([[c * rho, s * rho], [c * rho, s * rho]]) + np.array([[0.0], [far]]) * [-s, c]
        lines.append(strips.metres(edge, ends))
    return corner(*lines)


def _stronger(edges: np.ndarray, one: np.ndarray | None, other: np.ndarray | None) -> np.ndarray | None:
    """The line with more edge pixels on it; both lists are sorted by votes."""

    def votes(found: np.ndarray | None) -> int:
        if found is None:
            return -1
        rho, theta = np.ravel(found)[:2]
        v, u = np.nonzero(edges)
        return int(np.sum(np.abs(u * np.cos(theta) + v * np.sin(theta) - rho) < 1))

    return one if votes(one) >= votes(other) else other


def segments(picture: np.ndarray, strips: Strips, near: np.ndarray) -> np.ndarray | None:
    """OpenCV's line segments that lie on the lines of pose `near` (3,), joined and intersected."""
    detector = cv2.createLineSegmentDetector()
    lines = []
    for edge in (HINGE, BOTTOM):
        found = detector.detect(strips.cut(picture, edge))[0]
        if found is None:
            return None
        ends = strips.metres(edge, found.reshape(-1, 2).astype(float))
        c, s = np.cos(near[2]), np.sin(near[2])
        turned = (ends - near[:2]) @ np.array([[c, -s], [s, c]])  # door y, z
        across, along = (0, 1) if edge == HINGE else (1, 0)
        pairs = turned.reshape(-1, 2, 2)
        on = np.all(np.abs(pairs[..., across]) < 0.3 * MM, axis=1)
        on &= np.abs(np.diff(pairs[..., along], axis=1)[:, 0]) > 1.0 * MM
        if not on.any():
            return None
        chosen = pairs[on].reshape(-1, 2)
        weight = np.repeat(np.abs(np.diff(pairs[on][..., along], axis=1)[:, 0]), 2)
        slope, place = np.polyfit(chosen[:, along], chosen[:, across], 1, w=np.sqrt(weight))
        line = np.empty((2, 2))
        line[:, along] = 0.0, 0.1
        line[:, across] = place, place + 0.1 * slope
        lines.append(line @ np.array([[c, s], [-s, c]]) + near[:2])
    return corner(*lines)
