"""Where a wrong cause betrays itself in a loading test: halves of the trials, and errors that turn one joint."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.distributions import chi2_sf
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.load_case import LoadCase

_ROUNDING = 1e-9  #: share of the largest value that is no difference


def halves(data: Trials, case: LoadCase) -> dict[str, BoolArray]:
    """Ways to cut the trials in two, each a mask of shape (n,)."""
    force = np.linalg.norm(case.force, axis=1)
    cuts = {
        "load": _above(force, float(np.median(force))),
        "time": _above(data.time, float(np.median(data.time))),
        "load up or down": _above(case.force[:, 2], 0.0),
        "load left or right": _above(case.force[:, 1], 0.0),
    }
    for k in range(6):
        size = np.abs(case.torque[:, k])
        cuts[f"torque of joint {k + 1}"] = _above(size, float(np.median(size)))
        cuts[f"sign of the torque of joint {k + 1}"] = _above(case.torque[:, k], 0.0)
        cuts[f"angle of joint {k + 1}"] = _above(data.q[:, k], float(np.median(data.q[:, k])))
    for name in data.reflectors:
        cuts[f"reflector {name}"] = data.reflector == name
    share = {name: mask.mean() for name, mask in cuts.items()}
    return {name: mask for name, mask in cuts.items() if 0.1 <= share[name] <= 0.9}


def _above(values: FloatArray, limit: float) -> BoolArray:
    """Values above a limit by more than rounding, shape (n,): those of one posture stay on one side of it."""
    return values > limit + _ROUNDING * max(float(np.abs(values).max()), 1e-300)


def turning(case: LoadCase, whiten: FloatArray, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
    """The joint that some trials point along most, and the chance that slips of the hand would as much.

    The cosine of a random direction with a given one is uniform, so 1 - |cos| is a chance; Fisher's
    sum joins those of all gross errors. A slip of the hand does not know where the axes are.

    Args:
        case: Geometry of the trials.
        whiten: Inverse Cholesky factors of the noise, shape (n, 3, 3).
        residual: Whitened, shape (n, 3).
        gross: The trials in question, shape (n,).
    """
    if not gross.any():
        return "", 1.0
    away = residual[gross]
    chances = np.ones(6)
    for k in range(6):
        turn = np.einsum("nij,nj->ni", whiten[gross], case.joint_twist(k)[gross, :3])
        size = np.linalg.norm(turn, axis=1) * np.linalg.norm(away, axis=1)
        moved = size > 0.0
        if not moved.any():
            continue
        cosine = np.abs(np.sum(turn * away, axis=1)[moved]) / size[moved]
        joined = -2.0 * np.sum(np.log(np.maximum(1.0 - cosine, 1e-6)))
        chances[k] = chi2_sf(joined, 2 * int(moved.sum()))
    return f"joint {chances.argmin() + 1}", min(6.0 * float(chances.min()), 1.0)
