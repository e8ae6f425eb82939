"""Does a cause say the same in every part of the data? A wrong one that only resembles the truth does not."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from doormill_ros.diagnosis.causes.cause import Cause
from doormill_ros.diagnosis.fit import Fit
from doormill_ros.diagnosis.problem import Problem

#: Share of random shuffles in which gross errors sit together as closely.
CLUSTERED = 1e-3


def halves(problem: Problem) -> dict[str, np.ndarray]:
    """Ways to cut the trials in two, each a mask of shape (n,)."""
    data, case = problem.data, problem.case
    force = np.linalg.norm(case.force, axis=1)
    cuts = {
        "load": force > np.median(force),
        "time": data.time > np.median(data.time),
        "load up or down": case.force[:, 2] > 0.0,
        "load left or right": case.force[:, 1] > 0.0,
    }
    for k in range(6):
        size = np.abs(case.torque[:, k])
        cuts[f"torque of joint {k + 1}"] = size > np.median(size)
        cuts[f"sign of the torque of joint {k + 1}"] = case.torque[:, k] > 0.0
        cuts[f"angle of joint {k + 1}"] = data.q[:, k] > np.median(data.q[:, k])
    for name in data.reflectors:
        cuts[f"reflector {name}"] = data.reflector == name
    share = {name: mask.mean() for name, mask in cuts.items()}
    return {name: mask for name, mask in cuts.items() if 0.1 <= share[name] <= 0.9}


def instability(problem: Problem, found: Fit, cause: Cause) -> tuple[float, str, float]:
    """Smallest probability, over all cuts, that both halves hold the same cause of the same size.

    The residual's own size is the yardstick, so that structure left by something else does not
    condemn a cause by itself. The probability is corrected for the number of cuts.

    Returns:
        Probability, the cut that gave it, and how far the halves are apart there as a share of the cause.
    """
    part = found.part(cause)
    prediction, weights = found.prediction, np.sqrt(found.weights)[:, None]
    target = (prediction.white * weights).ravel()
    base = prediction.jacobian * weights[:, :, None]
    kept = float((found.weights > 0.0).sum())
    freedom = max(problem.components * kept - found.size, 1.0)
    left = float(target @ target)
    cuts = halves(problem)
    size = max(float(np.linalg.norm(found.theta[part])), 1e-30)
    worst, where, apart = 1.0, "", 0.0
    for name, mask in cuts.items():
        own = base[:, :, part] * mask[:, None, None]
        block = np.concatenate([base, own], axis=2).reshape(len(target), -1)
        solution, _, rank, _ = np.linalg.lstsq(block, target, rcond=1e-9)
        gain = left - float(np.sum((target - block @ solution) ** 2))
        after = max(freedom - (rank - found.size), 1.0)
        scale = max((left - gain) / after, 1.0)
        probability = float(chi2.sf(max(gain, 0.0) / scale, max(rank - found.size, 1)))
        if probability < worst:
            worst, where = probability, name
            apart = float(np.linalg.norm(solution[found.size :])) / size
    return min(1.0, worst * len(cuts)), where, apart


def clustered(problem: Problem, gross: np.ndarray, seed: int = 0) -> bool:
    """Whether gross errors sit together in few configurations or on one reflector.

    Slips of the hand fall anywhere; an unknown effect that shows in a few postures only does not.

    Args:
        problem: The set.
        gross: The trials in question, shape (n,).
        seed: Of the 2000 shuffles they are compared with.
    """
    if gross.sum() < 3:
        return False
    rng = np.random.default_rng(seed)
    shuffles = np.stack([rng.permutation(gross) for _ in range(2000)])
    for groups in (problem.configuration, problem.data.reflector):
        _, number = np.unique(groups, return_inverse=True)
        member = np.eye(number.max() + 1)[number]
        together = float(np.sum((gross @ member) ** 2))
        if np.mean(np.sum((shuffles @ member) ** 2, axis=1) >= together) < CLUSTERED:
            return True
    return False
