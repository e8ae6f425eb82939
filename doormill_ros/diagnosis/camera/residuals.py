"""What the camera model gets wrong: repeated localisations of a door that was moved by known amounts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.camera.causes import CameraCause, camera_causes
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.problem import Prediction, Problem, make_folds
from doormill_ros.diagnosis.core.search import EQUAL, Search
from doormill_ros.diagnosis.core.verdict import CONSISTENT, EXPLAINED, UNEXPLAINED
from doormill_ros.measurements.picture_reading import Localisations

STRUCTURE = 1e-4  #: chance of an innocent residual below which something is wrong


class PictureProblem(Problem[CameraCause]):
    """Localisations in the form that search and fit work on.

    Attributes:
        data: The localisations.
        cache: Columns of causes that have been asked for.
        folds: Positions that are left out together, shape (n,).
    """

    def __init__(self, data: Localisations) -> None:
        """Weigh by the noise; every position of the door is one group."""
        self.data, self.components = data, 3
        self.cache: dict[tuple[str, str, str], FloatArray] = {}
        _, groups = np.unique(np.round(data.moved, 6), axis=0, return_inverse=True)
        self.configuration = groups.ravel()
        self.folds = make_folds(self.configuration)
        self.noise_floor = float(np.sqrt(np.mean(np.asarray(data.std) ** 2)))
        self.whiten = np.broadcast_to(np.diag(1.0 / data.std), (len(data.time), 3, 3))

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
        slope = np.concatenate([none] + [self._columns(cause) for cause in members], axis=2)
        residual = self.data.located - self.data.moved - slope @ theta
        white = residual / self.data.std
        cost = np.sum(white**2, axis=1)
        return Prediction(residual, white, cost, slope / self.data.std[:, None] if derivative else None)

    def slope(self, cause: CameraCause, theta: FloatArray) -> FloatArray:
        """Whitened derivative of the prediction by one cause alone, shape (n, 3, p)."""
        return self._columns(cause) / self.data.std[:, None]

    def _columns(self, cause: CameraCause) -> FloatArray:
        if cause.identity not in self.cache:
            self.cache[cause.identity] = cause.unit(self.data)
        return self.cache[cause.identity]

    def measured_part(self, white: FloatArray) -> FloatArray:
        """Residual in metres and radians of a whitened one, shape (n, 3)."""
        return white * self.data.std


@dataclass(frozen=True, eq=False)
class CameraFinding:
    """One camera error: the cause, its values with standard deviations, and what would do as well."""

    cause: CameraCause
    values: FloatArray
    std: FloatArray
    confusable: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class CameraDiagnosis:
    """What the camera model gets wrong.

    Attributes:
        verdict: consistent, explained or unexplained, as for a loading test.
        findings: Established errors; none when unexplained.
        before, after: Root mean square over the noise, held out: 1 is perfect.
        fit: The model behind it.
    """

    verdict: str
    findings: tuple[CameraFinding, ...]
    before: float
    after: float
    fit: Fit[CameraCause]


def diagnose_pictures(data: Localisations) -> CameraDiagnosis:
    """Question a camera model with localisations of a door moved by known amounts."""
    problem = PictureProblem(data)
    search = Search(problem, camera_causes(data.reading is not None))
    best = search.run()
    empty = search.fit(())
    kept = best.weights > 0.0
    freedom = max(3 * int(kept.sum()) - best.size, 1)
    structure = float(chi2.sf(np.sum(best.prediction.cost[kept]), freedom)) < STRUCTURE
    findings = []
    for cause in () if structure else best.members:
        part = best.part(cause)
        rivals = [
            other.name
            for other, found in search.rivals(best, cause)
            if found.held_out_score < best.held_out_score + EQUAL
        ]
        std = np.sqrt(np.diag(best.covariance)[part])
        findings.append(CameraFinding(cause, best.theta[part], std, tuple(rivals)))
    verdict = UNEXPLAINED if structure else EXPLAINED if findings else CONSISTENT
    size = [float(np.sqrt(np.mean((f.held_out[kept] / data.std) ** 2))) for f in (empty, best)]
    return CameraDiagnosis(verdict, tuple(findings), size[0], size[1] if findings else size[0], best)
