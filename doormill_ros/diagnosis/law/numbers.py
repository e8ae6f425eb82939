"""What was established in the fit that holds the laws, too: one model has one set of numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit, normal_equations
from doormill_ros.diagnosis.core.fitting.held_out import scatter_of
from doormill_ros.diagnosis.law.linear import Established, LinearProblem


def numbers_beside(problem: LinearProblem, found: Fit[Any]) -> tuple[FloatArray, FloatArray]:
    """Coefficients of what was established beside laws, and their standard deviations, shape (m,) each.

    The deviations are those of the fit, or from the scatter of what is left out together where that is larger.

    Args:
        problem: What was left to explain.
        found: A model that begins with what was established; terms of laws follow.
    """
    base = found.members[0]
    assert isinstance(base, Established)
    prediction = problem.predict(found.members, found.theta, derivative=True)
    hessian, _ = normal_equations(prediction, found.weights)
    size = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    covariance = np.linalg.pinv(hessian / size / size[:, None], hermitian=True) / size / size[:, None]
    pulls = np.einsum("n,ncp,nc->np", found.weights, prediction.derived, prediction.white)
    _, block = np.unique(problem.configuration, return_inverse=True)
    by_block = np.zeros((block.max() + 1, found.size))
    np.add.at(by_block, block, pulls)
    M, part = base.coefficients, found.part(base)
    variance = np.einsum("mp,pq,mq->m", M, covariance[part, part], M)
    scatter = scatter_of(by_block, covariance[:, part] @ M.T)
    values = base.values(found.theta[part], problem.case)
    return values, np.sqrt(np.maximum(variance, scatter**2) + base.unsaid)
