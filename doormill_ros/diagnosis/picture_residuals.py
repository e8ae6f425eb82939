"""What the camera model gets wrong: repeated localisations of a door that was moved by known amounts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import chi2

from doormill_ros.cell.layout import CellLayout, DoorOffset
from doormill_ros.diagnosis.causes.cause import LinearTwist, Parameter
from doormill_ros.diagnosis.fit import Fit
from doormill_ros.diagnosis.problem import Prediction, make_folds
from doormill_ros.diagnosis.search import EQUAL, Search
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.result import Localization

STRUCTURE = 1e-4  #: chance of an innocent residual below which something is wrong


@dataclass(frozen=True, eq=False)
class Localisations:
    """Repeated localisations; all lengths in the plane of the door.

    Attributes:
        moved: Known y, z and rotation of the door, shape (n, 3) [m, m, rad].
        located: What the pictures gave, shape (n, 3).
        time: When each picture was taken, shape (n,) [s].
        std: Standard deviation of one localisation, shape (3,) [m, m, rad].
        centre: Where the optical axis meets the door plane, y and z, shape (2,) [m].
    """

    moved: np.ndarray
    located: np.ndarray
    time: np.ndarray
    std: np.ndarray
    centre: np.ndarray = field(default_factory=lambda: np.zeros(2))

    @property
    def place(self) -> np.ndarray:
        """Position in the picture's field, from the optical axis, shape (n, 2) [m]."""
        return self.moved[:, :2] - self.centre


def localisations_of(
    found: Sequence[Localization],
    moved: Sequence[DoorOffset],
    time: np.ndarray,
    camera: CameraModel,
    layout: CellLayout,
    width: float,
) -> Localisations:
    """What the localizer said of pictures of one door, in the form that is questioned.

    Args:
        found: Results, one a picture, by `LocalizerSettings.picture_only`: what is wrong alike in all pictures is
            no scatter.
        moved: Where the door was known to stand.
        time: When each picture was taken, shape (n,) [s].
        camera: The camera model that the localizer used.
        layout: The nominal place of the door.
        width: Door width [m].
    """
    corner = np.array([layout.centre_y - width / 2.0, layout.bottom_z])
    return Localisations(
        moved=np.array([_numbers(offset) for offset in moved]),
        located=np.array([_numbers(one.offset) for one in found]),
        time=np.asarray(time, dtype=float),
        std=np.sqrt(np.mean([np.diag(one.covariance) for one in found], axis=0)),
        centre=camera.T_base_camera(width)[1:3, 3] - corner,
    )


def _numbers(offset: DoorOffset) -> tuple[float, float, float]:
    return offset.y, offset.z, offset.rotation


class CameraCause(LinearTwist):
    """A camera error that is linear in its parameters."""

    def __init__(
        self,
        name: str,
        parameters: tuple[Parameter, ...],
        columns: Callable[[Localisations], list[np.ndarray]],
        sentence: str,
    ) -> None:
        """Keep the columns: y, z and rotation each parameter adds, shape (n, 3)."""
        super().__init__("camera")
        size = sum(p.size for p in parameters)
        self.name, self.parameters, self.columns, self._sentence = name, parameters, columns, sentence
        self.scale = np.repeat([abs(p.high) for p in parameters], [p.size for p in parameters]) / 30.0
        self.lower, self.upper = -np.ones(size) * 1e3, np.ones(size) * 1e3

    def pattern(self) -> str:
        """What it leaves."""
        return self._sentence

    def values(self, theta: np.ndarray, case: object = None) -> np.ndarray:
        """Parameters as they are."""
        return np.array(theta)


def _plane(y: np.ndarray, z: np.ndarray) -> np.ndarray:
    return np.stack([y, z, np.zeros_like(y)], axis=1)


def camera_causes() -> list[CameraCause]:
    """Scale, turn, tilt, distortion, drift and placing of the camera."""
    return [
        CameraCause(
            "camera_scale",
            (Parameter("factor_error", "1", -0.1, 0.1),),
            lambda s: [_plane(*s.moved[:, :2].T)],
            "the error grows with the distance the door was moved, along that distance",
        ),
        CameraCause(
            "camera_turn",
            (Parameter("angle", "rad", -0.1, 0.1),),
            lambda s: [_plane(-s.moved[:, 1], s.moved[:, 0])],
            "the error grows with the distance the door was moved, across that distance",
        ),
        CameraCause(
            "camera_tilt",
            (Parameter("slope", "1 / m", -5.0, 5.0, 2),),
            lambda s: [
                _plane(s.place[:, 0] * s.place[:, i], s.place[:, 1] * s.place[:, i])
                - _plane(*np.outer(s.centre * s.centre[i], np.ones(len(s.time))))
                for i in (0, 1)
            ],
            "the scale changes from one side of the picture to the other",
        ),
        CameraCause(
            "camera_distortion",
            (Parameter("k1", "1 / m^2", -500.0, 500.0),),
            lambda s: [_plane(*(np.sum(s.place**2, axis=1)[:, None] * s.place).T)],
            "the error points from the optical axis and grows with the cube of the distance from it",
        ),
        CameraCause(
            "camera_drift",
            (Parameter("velocity", "m / s, rad / s", -1e-5, 1e-5, 3),),
            lambda s: [(s.time - s.time[0])[:, None] * e for e in np.eye(3)],
            "the error grows with the time since the first picture, wherever the door stands",
        ),
        CameraCause(
            "camera_placing",
            (Parameter("offset", "m, m, rad", -0.01, 0.01, 3),),
            lambda s: [np.broadcast_to(e, s.moved.shape) for e in np.eye(3)],
            "the error is the same everywhere",
        ),
    ]


class PictureProblem:
    """Localisations in the form that search and fit work on.

    Attributes:
        data: The localisations.
        case: Itself; causes find the localisations there.
        cache: Columns of causes that have been asked for.
        folds: Positions that are left out together, shape (n,).
    """

    components = 3

    def __init__(self, data: Localisations) -> None:
        """Weigh by the noise; every position of the door is one group."""
        self.data, self.cache = data, {}
        self.case = self
        _, groups = np.unique(np.round(data.moved, 6), axis=0, return_inverse=True)
        self.folds = make_folds(groups.ravel())
        self.whiten = np.broadcast_to(np.diag(1.0 / data.std), (len(data.time), 3, 3))

    def __len__(self) -> int:
        return len(self.data.time)

    def predict(
        self, members: Sequence[CameraCause], theta: np.ndarray, derivative: bool = False
    ) -> Prediction:
        """Residuals of a set of camera errors, as `Problem.predict`."""
        none = np.zeros((len(self), 3, 0))
        slope = np.concatenate([none] + [self._columns(cause) for cause in members], axis=2)
        residual = self.data.located - self.data.moved - slope @ theta
        white = residual / self.data.std
        cost = np.sum(white**2, axis=1)
        return Prediction(residual, white, cost, slope / self.data.std[:, None] if derivative else None)

    def slope(self, cause: CameraCause, theta: np.ndarray) -> np.ndarray:
        """Whitened derivative of the prediction by one cause alone, shape (n, 3, p)."""
        return self._columns(cause) / self.data.std[:, None]

    def _columns(self, cause: CameraCause) -> np.ndarray:
        if cause.identity not in self.cache:
            self.cache[cause.identity] = np.stack(cause.columns(self.data), axis=2)
        return self.cache[cause.identity]

    def measured_part(self, white: np.ndarray) -> np.ndarray:
        """Residual in metres and radians of a whitened one, shape (n, 3)."""
        return white * self.data.std


@dataclass(frozen=True, eq=False)
class CameraFinding:
    """One camera error: the cause, its values with standard deviations, and what would do as well."""

    cause: CameraCause
    values: np.ndarray
    std: np.ndarray
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
    fit: Fit


def diagnose_pictures(data: Localisations) -> CameraDiagnosis:
    """Question a camera model with localisations of a door moved by known amounts."""
    problem = PictureProblem(data)
    search = Search(problem, camera_causes())
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
    verdict = "unexplained" if structure else "explained" if findings else "consistent"
    size = [float(np.sqrt(np.mean((f.held_out[kept] / data.std) ** 2))) for f in (empty, best)]
    return CameraDiagnosis(verdict, tuple(findings), size[0], size[1] if findings else size[0], best)
