"""Camera errors that localisations of a door moved by known amounts can show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.camera import CameraModel
from doormill_ros.measurements.picture_reading import DoorReading, Localisations
from doormill_ros.robot_model.candidate import Candidate, CauseParameter

_STEP = 3e-3  #: share of the plausible range for which a camera model is made wrong to derive its reading

#: Gives a camera model with errors of the sizes given, shape (p,), for what reads the door.
Wrong = Callable[[CameraModel, FloatArray, DoorReading], CameraModel]


class CameraCause(Candidate[Localisations]):
    """A camera error that is linear in its parameters.

    Two statements of one thing: columns of an ideal pinhole, and the camera model with that error. The second is
    right for a real lens, where for example a wrong focal length undoes the distortion at the wrong radius and so
    bends the door besides scaling it. It is used wherever the camera model is known.
    """

    of_robot = False

    def __init__(
        self,
        name: str,
        parameter: CauseParameter,
        pattern: str,
        columns: Callable[[Localisations], list[FloatArray]] | None = None,
        wrong: Wrong | None = None,
    ) -> None:
        """Keep what it does.

        Args:
            name: Of the error.
            parameter: Its size.
            pattern: One sentence: what it leaves.
            columns: y, z and rotation that a pinhole with each component adds, shape (n, 3); None when a pinhole
                cannot tell it from another error.
            wrong: The camera model with it; None for an error that is not in that model.
        """
        super().__init__("camera")
        self.name, self.parameters, self._sentence = name, (parameter,), pattern
        self.columns, self.wrong = columns, wrong
        self.scale = np.full(parameter.size, parameter.high / 30.0)
        self.lower, self.upper = np.full(parameter.size, -1e3), np.full(parameter.size, 1e3)

    def pattern(self) -> str:
        """What it leaves."""
        return self._sentence

    def values(self, theta: FloatArray, case: Localisations | None = None) -> FloatArray:
        """Parameters as they are, shape (p,)."""
        return np.array(theta)

    def unit(self, case: Localisations) -> FloatArray:
        """y, z and rotation for a unit of each component, shape (n, 3, p) [m, m, rad]."""
        reading, (parameter,) = case.reading, self.parameters
        wrong = self.wrong
        if reading is None or wrong is None:
            assert self.columns is not None, "left out of the candidates where no camera model is known"
            return np.stack(self.columns(case), axis=2)
        made_wrong, known = wrong, reading

        def along(unit: FloatArray) -> FloatArray:
            derivative: FloatArray = known.derivative(
                case.moved,
                lambda camera, size: made_wrong(camera, size * unit, known),
                _STEP * parameter.high,
            )
            return derivative

        return np.stack([along(unit) for unit in np.eye(parameter.size)], axis=2)


def _plane(y: FloatArray, z: FloatArray) -> FloatArray:
    return np.stack([y, z, np.zeros_like(y)], axis=1)


def _turned(camera: CameraModel, by: Sequence[float] | FloatArray) -> CameraModel:
    return replace(camera, rotation_vector=camera.rotation_vector + np.array(by))


def _focal(camera: CameraModel, factor: float) -> CameraModel:
    k = np.array(camera.k)
    k[:2, :2] *= factor
    return replace(camera, k=k)


def camera_causes(known: bool = True) -> list[CameraCause]:
    """Scale, distance, turn, tilt, distortion, drift and placing of the camera.

    Args:
        known: Whether the camera model is known; a wrong distance cannot be told from a wrong scale without.
    """
    causes = [
        CameraCause(
            "camera_scale",
            CauseParameter("factor_error", "1", -0.1, 0.1),
            "the error grows with the distance the door was moved, along that distance",
            lambda s: [_plane(*s.moved[:, :2].T)],
            lambda camera, size, reading: _focal(camera, 1.0 / (1.0 + size[0])),
        ),
        CameraCause(
            "camera_distance",
            CauseParameter("factor_error", "1", -0.1, 0.1),
            "the error grows with the distance the door was moved, along that distance, and the lens bends nothing",
            None,
            lambda camera, size, reading: replace(
                camera, position=camera.position - size[0] * reading.distance * np.eye(3)[0]
            ),
        ),
        CameraCause(
            "camera_turn",
            CauseParameter("angle", "rad", -0.1, 0.1),
            "the error grows with the distance the door was moved, across that distance",
            lambda s: [_plane(-s.moved[:, 1], s.moved[:, 0])],
            lambda camera, size, reading: _turned(camera, [0.0, 0.0, size[0]]),
        ),
        CameraCause(
            "camera_tilt",
            CauseParameter("slope", "1 / m", -5.0, 5.0, 2),
            "the scale changes from one side of the picture to the other",
            lambda s: [
                _plane(s.place[:, 0] * s.place[:, i], s.place[:, 1] * s.place[:, i])
                - _plane(*np.outer(s.centre * s.centre[i], np.ones(len(s.time))))
                for i in (0, 1)
            ],
            # Scale grows by distance times angle a metre; camera x is -y of the base, camera y is -z.
            lambda camera, size, reading: _turned(
                camera, reading.distance * np.array([size[1], -size[0], 0.0])
            ),
        ),
        CameraCause(
            "camera_distortion",
            CauseParameter("k1", "1 / m^2", -500.0, 500.0),
            "the error points from the optical axis and grows with the cube of the distance from it",
            lambda s: [_plane(*(np.sum(s.place**2, axis=1)[:, None] * s.place).T)],
            lambda camera, size, reading: replace(
                camera, distortion=camera.distortion - size[0] * reading.distance**2 * np.eye(5)[0]
            ),
        ),
        CameraCause(
            "camera_drift",
            CauseParameter("velocity", "m / s, rad / s", -1e-5, 1e-5, 3),
            "the error grows with the time since the first picture, wherever the door stands",
            lambda s: [(s.time - s.time[0])[:, None] * e for e in np.eye(3)],
        ),
        CameraCause(
            "camera_placing",
            CauseParameter("offset", "m, m, rad", -0.01, 0.01, 3),
            "the error is the same everywhere",
            lambda s: [np.broadcast_to(e, s.moved.shape) for e in np.eye(3)],
        ),
    ]
    return [cause for cause in causes if known or cause.columns is not None]
