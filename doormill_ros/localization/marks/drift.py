"""How far the camera is from where it was calibrated, by the cell's marks, and what that does to a door."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from doormill_ros.arrays import BoolArray, ByteArray, FloatArray
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import CameraMoved, MarksMissing
from doormill_ros.localization.marks.mark_finder import find_marks
from doormill_ros.localization.marks.marked_view import MarkedView, marked_view
from doormill_ros.units import m_to_mm, rad_to_deg

FEWEST = 4
_FOUND = 0.05  # px, standard deviation of a dot's centre
_OUTLIER = 5.0  # standard deviations at which a dot does not stand where it stood
_KEPT = 0.6  # share of the dots that must agree
# A fit may have y, z [m], turns about x, y, z [rad] and the size of the picture; what it cannot tell apart stays there.
_PRIOR = np.array([5e-3, 5e-3, 0.05, 0.05, 0.05, 0.05])
_SMALL = 1e-4  # step after which the fit is as good as linear
#: None, picture's size, place, turn, place and turn, all.
_CAUSES = ((), (5,), (0, 1), (2, 3, 4), (0, 1, 2, 3, 4), (0, 1, 2, 3, 4, 5))


@dataclass(frozen=True, eq=False)
class Drift:
    """What the marks say of the camera.

    Attributes:
        moved: Its shift along base x, y, z since the calibration [m], shape (3,); along x always 0, see `growth`.
        turned: Its turn about base x, y, z [rad], shape (3,).
        growth: Of the picture, as a share: the focal length, or the camera's way towards the marks.
        nearer: That way, if it is one [m].
        door: By how much a door's y, z [m] and rotation [rad] come out too large, shape (3,).
        deviations: Of `door`, shape (3,).
        limit: What is allowed of `door`, shape (3,).
        seen: Marks that were seen and agree.
    """

    moved: FloatArray
    turned: FloatArray
    growth: float
    nearer: float
    door: FloatArray
    deviations: FloatArray
    limit: FloatArray
    seen: int

    @property
    def share(self) -> float:
        """Of the limit that is used up."""
        return float(np.max(np.abs(self.door) / self.limit))

    @property
    def sentence(self) -> str:
        """What happened to the camera and how much, by the simplest cause that explains the marks."""
        parts, said = [], []
        if self.moved.any():
            parts.append(f"moved by {m_to_mm(float(np.linalg.norm(self.moved))):.2f} mm")
        if self.turned.any():
            parts.append(f"turned by {rad_to_deg(float(np.linalg.norm(self.turned))):.2f} degrees")
        if self.growth:
            word, way = ("grown", "nearer") if self.growth > 0 else ("shrunk", "further away")
            said.append(
                f"the camera's pictures have {word} by {100 * abs(self.growth):.2f} % (another focal length, or it "
                f"stands {m_to_mm(abs(self.nearer)):.2f} mm {way})"
            )
        if parts or not said:
            said.append("the camera has " + (" and ".join(parts) or "not moved"))
        return ", ".join(reversed(said))


def drift_in(
    picture: ByteArray, camera: CameraModel | None, width: float, corner: FloatArray
) -> Drift | None:
    """What the marks in a picture say; None for a cell that has none.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        camera: The camera as it was calibrated.
        width: Door width, for which the slider stands [m].
        corner: Nominal corner of the door's face in base, shape (3,) [m].

    Raises:
        CameraMoved: A door would come out further off than `marks.limit` allows.
        MarksMissing: Too few marks are seen, they do not agree, or they leave too much open.
    """
    if camera is None or camera.marks is None:
        return None
    view = marked_view(camera, camera.marks, width)
    drift = drift_of(find_marks(picture, view.expected, view.radii), view, corner)
    if drift.share > 1.0:
        place, turn = m_to_mm(drift.door[:2]), rad_to_deg(float(drift.door[2]))
        allowed, most = m_to_mm(drift.limit[:2]), rad_to_deg(float(drift.limit[2]))
        raise CameraMoved(
            f"{drift.sentence}; a door seems {place[0]:+.3f} mm, {place[1]:+.3f} mm and {turn:+.3f} degrees off "
            f"by that, allowed are {allowed[0]:.3f} mm, {allowed[1]:.3f} mm and {most:.3f} degrees; fasten the camera, "
            "run calibrate and configure the localizer again",
            drift=drift,
        )
    return drift


def drift_of(seen: FloatArray, view: MarkedView, corner: FloatArray) -> Drift:
    """What the centres of the marks say, u, v [px], shape (n, 2), nan where one was not seen.

    Args:
        seen: The centres.
        view: The camera before the marks as it was calibrated.
        corner: Nominal corner of the door's face in base, shape (3,) [m].

    Raises:
        MarksMissing: Too few marks are seen, they do not agree, or they leave too much open.
    """
    marks, camera = view.marks, view.camera
    distance = marks.x - float(camera.position[0])
    sigma = float(np.hypot(_FOUND, marks.deviation * camera.k[0, 0] / distance))
    used: BoolArray = np.isfinite(seen[:, 0])
    fewest = max(FEWEST, int(np.ceil(_KEPT * len(seen))))
    while True:
        if used.sum() < fewest:
            raise MarksMissing(
                f"{used.sum()} of {len(seen)} marks of the cell are seen where they stood, {fewest} are needed to "
                "check the camera; clean them, clear the view, or fasten and calibrate the camera if it was knocked",
                seen=seen,
            )
        parameters, covariance, left = _fit(view, used, seen[used], sigma, tuple(range(6)))
        worst = np.linalg.norm(left, axis=1)
        if worst.max() <= _OUTLIER * sigma:
            break
        used[np.flatnonzero(used)[int(np.argmax(worst))]] = False
    effect = view.effect(tuple(corner.tolist()))
    limit, deviations = np.array(marks.limit), np.sqrt(np.diag(effect @ covariance @ effect.T))
    if np.any(2.0 * deviations > limit):
        raise MarksMissing(
            f"{used.sum()} marks are seen; they tell its effect on a door to {m_to_mm(deviations[0]):.3f} mm, "
            f"{m_to_mm(deviations[1]):.3f} mm and {rad_to_deg(float(deviations[2])):.4f} degrees, half of marks.limit "
            "is needed; put marks on two sides of the picture, far apart",
            seen=seen,
        )
    told = _simplest(view, used, seen[used], sigma)
    growth = float(told[5])
    return Drift(
        moved=np.array([0.0, told[0], told[1]]),
        turned=told[2:5],
        growth=growth,
        nearer=distance * growth,
        door=effect @ parameters,
        deviations=deviations,
        limit=limit,
        seen=int(used.sum()),
    )


def _fit(
    view: MarkedView, used: BoolArray, seen: FloatArray, sigma: float, free: tuple[int, ...]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Parameters (6,), their covariance (6, 6), residuals (m, 2) [px] of some marks (n,), bool, seen at (m, 2)."""
    parameters, kept = np.zeros(6), list(free)
    covariance: FloatArray = np.zeros((6, 6))
    inverse: FloatArray = covariance
    for _ in range(4 if kept else 0):
        rows = view.slopes(used, parameters)[:, kept] / sigma
        left = (seen - view.seen(used, parameters)).ravel() / sigma
        inverse = linalg.inv(rows.T @ rows + np.diag(_PRIOR[kept] ** -2))
        step = inverse @ (rows.T @ left - parameters[kept] / _PRIOR[kept] ** 2)
        parameters[kept] += step
        if np.abs(step).max() < _SMALL:
            break
    if kept:
        covariance[np.ix_(kept, kept)] = inverse
    return parameters, covariance, seen - view.seen(used, parameters)


def _simplest(view: MarkedView, used: BoolArray, seen: FloatArray, sigma: float) -> FloatArray:
    """Parameters (6,) of the cause with the fewest of them that explains the marks (Schwarz' criterion)."""
    best, least = np.zeros(6), np.inf
    for free in _CAUSES:
        if not best.any() and least <= seen.size:  # nothing has happened
            break
        parameters, _, left = _fit(view, used, seen, sigma, free)
        cost = float(np.sum((left / sigma) ** 2)) + len(free) * np.log(left.size)
        if cost < least:
            best, least = parameters, cost
    return best
