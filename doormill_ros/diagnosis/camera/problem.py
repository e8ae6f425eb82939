"""Repeated localisations of a door that was moved by known amounts, made ready for the search."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.camera.causes import CameraCause, camera_causes
from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.fitting.problem import Examined, Prediction, make_folds
from doormill_ros.diagnosis.core.words.wording import Unit
from doormill_ros.measurements.picture_reading import Localisations

#: Lengths and an angle together: each counts by its own standard deviation.
UNIT = Unit(
    "standard deviations of one localization", "times the localizer's own uncertainty", 2, 1.0, relative=True
)


class PictureProblem(Examined[CameraCause]):
    """Localisations in the form that search and fit work on.

    Attributes:
        data: The localisations.
        configuration: Number of the door's place, shape (n,).
        folds: Places that are left out together, shape (n,).
        cache: Columns of causes that have been asked for.
    """

    unit = UNIT
    components = 3
    noise_floor = 1.0

    def __init__(self, data: Localisations) -> None:
        """Every place of the door is one group."""
        self.data = data
        self.cache: dict[tuple[str, str, str], FloatArray] = {}
        _, groups = np.unique(np.round(data.moved, 6), axis=0, return_inverse=True)
        self.configuration = groups.ravel()
        self.folds = make_folds(self.configuration)

    def __len__(self) -> int:
        return len(self.data.time)

    @property
    def case(self) -> Localisations:
        """Where the causes find everything."""
        return self.data

    def predict(
        self, members: Sequence[CameraCause], theta: FloatArray, derivative: bool = False
    ) -> Prediction:
        """Residuals of a set of camera errors, as `Problem.predict`."""
        none = np.zeros((len(self), 3, 0))
        slope = np.concatenate([none] + [self.slope(cause, theta) for cause in members], axis=2)
        white = (self.data.located - self.data.moved) / self.data.std - slope @ theta
        return Prediction(white, white, np.sum(white**2, axis=1), slope if derivative else None)

    def slope(self, cause: CameraCause, theta: FloatArray) -> FloatArray:
        """Whitened derivative of the prediction by one cause alone, shape (n, 3, p)."""
        if cause.identity not in self.cache:
            self.cache[cause.identity] = cause.unit(self.data) / self.data.std[:, None]
        return self.cache[cause.identity]

    def measured_part(self, white: FloatArray) -> FloatArray:
        """The same, shape (n, 3): residuals are told in standard deviations."""
        return white

    def candidates(self) -> list[CameraCause]:
        """Every error of the camera; fewer where its model is not known."""
        return camera_causes(self.data.reading is not None)

    def bent(self) -> Self | None:
        """There is one model of a camera."""
        return None

    def cuts(self) -> dict[str, BoolArray]:
        """Early and late, and each way in which the door was moved; shape (n,)."""
        ways = {"time": self.data.time} | dict(
            zip(("place along y", "place along z", "rotation"), self.data.moved.T, strict=True)
        )
        halves = {name: way > np.median(way) for name, way in ways.items()}
        return {name: half for name, half in halves.items() if 0.1 <= half.mean() <= 0.9}

    def groupings(self) -> Sequence[IntArray]:
        """Places of the door, shape (n,)."""
        return (self.configuration,)

    def turning(self, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
        """A camera has no joints that gross errors could turn."""
        return "", 1.0

    def labels(self) -> IntArray:
        """Pictures, counted from 1, shape (n,)."""
        return np.arange(1, len(self) + 1)


#: What is known of a camera.
CameraDiagnosis = Diagnosis[PictureProblem, CameraCause]
