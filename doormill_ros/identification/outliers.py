"""Find loadings with gross errors (a reflector that slipped, a mistyped row) and fit without them.

One wrong millimetre outweighs a hundred right micrometres in least squares. The first fits therefore widen the
deviation of every loading that lies far off (Huber weights), so that the wrong ones cannot bend the fit; what
then still lies far off is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.identification.weighted import StiffnessFit, fit_stiffness
from doormill_ros.measurements.loading import Loadings
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.statistics import GROSS_SHARE, huber_weights, median_length

#: Residual of a loading, in what is usual for the set, beyond which it counts as wrong.
FAR = 6.0
_HUBER = 2.0
_ROUNDS = 25


@dataclass(frozen=True, eq=False)
class RobustFit:
    """A fit and what it left out.

    Attributes:
        fit: Fit to the loadings that were kept.
        kept: Rows of these loadings.
        outliers: Rows left out, worst first.
    """

    fit: StiffnessFit
    kept: IntArray
    outliers: IntArray


def fit_without_outliers(kinematics: Kinematics, loadings: Loadings) -> RobustFit:
    """Fit the joint stiffness to all loadings but those with gross errors, at most one in ten.

    Raises:
        IdentifiabilityError: The loadings tell no joint.
    """
    plain_std = loadings.displacement_std
    widened = loadings
    far = np.ones(len(loadings))
    for _ in range(_ROUNDS):
        last = far
        far = _distance(fit_stiffness(kinematics, widened), plain_std)
        if np.allclose(far, last, rtol=1e-3, atol=1e-3):
            break
        narrow = np.sqrt(huber_weights(far, _HUBER))
        widened = replace(loadings, displacement_std=plain_std / narrow[:, None])
    order = np.argsort(far)[::-1]
    most = int(GROSS_SHARE * len(loadings))
    outliers = order[:most][far[order[:most]] > FAR]
    kept = np.setdiff1d(np.arange(len(loadings)), outliers)
    return RobustFit(fit_stiffness(kinematics, loadings.pick(kept)), kept, outliers)


def _distance(fit: StiffnessFit, displacement_std: FloatArray) -> FloatArray:
    """Length of each loading's residual, 1 being usual for the set or for its declared noise, whichever is more."""
    length: FloatArray = np.linalg.norm(fit.residual / displacement_std, axis=1) / median_length(3)
    return length / max(1.0, float(np.median(length)))
