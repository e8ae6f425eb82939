"""How the cell's marks are seen by a camera that may have moved, and what its movement does to a door."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import rotation_from_vector
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.marks.marks import Marks

_STEP = 1e-5  # of a parameter, by which derivatives are taken
_LEVER = 0.1  # m along the hinge edge, by which a door's rotation is told


class MarkedView:
    """Marks before a camera that may not be where it was calibrated.

    Parameters are its shift along y, z [m], its turns about x, y, z [rad] and the growth of its pictures, as a share.

    Attributes:
        camera: The camera as it was calibrated.
        marks: Where the marks stand.
        expected: Where they are seen if the camera is there, u, v [px], shape (n, 2).
        radii: Of their dots [px], shape (n,).
    """

    def __init__(self, camera: CameraModel, marks: Marks, width: float) -> None:
        """Put the marks before a camera whose slider stands for a door of `width` [m]."""
        self.camera, self.marks, self._width = camera, marks, width
        self._centre = camera.T_base_camera(width)[:3, 3]
        self._centres = marks.centres(width)
        self.expected = camera.project(self._centres, width)
        rims = camera.project(self._centres + np.array([0.0, marks.radius, 0.0]), width)
        self.radii: FloatArray = np.linalg.norm(rims - self.expected, axis=1)
        # A camera hardly ever moves: how its marks are seen if it did not is kept.
        still = np.zeros(6)
        self._still: FloatArray = self.pixels(self._centres, still[None])[0]
        self._still_slopes = self.jacobian(self._centres, still).reshape(-1, 2, 6)

    def seen(self, used: BoolArray, parameters: FloatArray) -> FloatArray:
        """Pixels (m, 2) of some marks (n,), bool, for the parameters (6,)."""
        moved = parameters.any()
        seen: FloatArray = (
            self.pixels(self._centres[used], parameters[None])[0] if moved else self._still[used]
        )
        return seen

    def slopes(self, used: BoolArray, parameters: FloatArray) -> FloatArray:
        """Derivatives of `seen` by the parameters, shape (2 m, 6)."""
        if parameters.any():
            return self.jacobian(self._centres[used], parameters)
        still: FloatArray = self._still_slopes[used].reshape(-1, 6)
        return still

    def pixels(self, points: FloatArray, parameters: FloatArray) -> FloatArray:
        """u, v [px], shape (m, n, 2), of points (n, 3) [m] for parameters (m, 6)."""
        turns = rotation_from_vector(parameters[:, 2:5])
        shifts = np.zeros((len(parameters), 1, 3))
        shifts[:, 0, 1:] = parameters[:, :2]
        seen = (points - self._centre - shifts) @ turns + self._centre
        middle, growth = self.camera.k[:2, 2], 1.0 + parameters[:, 5, None, None]
        pixels: FloatArray = middle + growth * (self.camera.project(seen, self._width) - middle)
        return pixels

    def jacobian(self, points: FloatArray, parameters: FloatArray) -> FloatArray:
        """Of the pixels of points (n, 3) [m] by the parameters (6,), shape (2 n, 6)."""
        steps = _STEP * np.eye(6)
        ahead, back = np.split(self.pixels(points, parameters + np.vstack([steps, -steps])), 2)
        return (ahead - back).reshape(6, -1).T / (2.0 * _STEP)

    @lru_cache(maxsize=8)  # noqa: B019  views are few and live in a cache themselves
    def effect(self, corner: tuple[float, float, float]) -> FloatArray:
        """Error of a door's y, z and rotation by the parameters, shape (3, 6): where its old camera sees its pixels."""
        errors = []
        for point in (np.array(corner), np.array(corner) + np.array([0.0, 0.0, _LEVER])):
            seen = self.jacobian(point[None], np.zeros(6))
            # A door that moves by y, z moves in the picture against what a camera does that moves so.
            errors.append(np.linalg.solve(-seen[:, :2], seen))
        low, high = errors
        return np.vstack([low, -(high[0] - low[0]) / _LEVER])


@lru_cache(maxsize=8)
def marked_view(camera: CameraModel, marks: Marks, width: float) -> MarkedView:
    """A view, made once for each door width [m]."""
    return MarkedView(camera, marks, width)
