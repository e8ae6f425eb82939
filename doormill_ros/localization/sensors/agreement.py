"""Whether sensors that looked at the same door found it in the same place, as far as each says how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import twist_between
from doormill_ros.localization.sensors.errors import SensorsDisagree
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM, SensedDoor
from doormill_ros.units import m_to_mm, rad_to_deg

#: Probability that a door is refused though all its sensors keep what they state.
CHANCE = 1.0e-4


def check_agreement(doors: Sequence[SensedDoor]) -> None:
    """Compare every two sensors in what both see.

    The difference d of two independent poses has covariance C = C1 + C2, and d^T C^-1 d is chi-square with as many
    degrees of freedom as both see. CHANCE is shared among the pairs (Bonferroni).

    Raises:
        SensorsDisagree: Two of them are further apart than that allows.
    """
    pairs = list(combinations(doors, 2))
    for one, other in pairs:
        _compare(one, other, CHANCE / len(pairs))


def rehearse_agreement() -> None:
    """Let two sensors agree, so that the first door does not wait for what that takes."""
    check_agreement([SensedDoor("", np.eye(4), np.eye(6), (True,) * 6)] * 2)


def _compare(one: SensedDoor, other: SensedDoor, chance: float) -> None:
    shared = [i for i in range(6) if one.sees[i] and other.sees[i]]
    if not shared:
        return
    apart = twist_between(one.T_base_door, other.T_base_door)[shared]
    size = _deviations(apart, (one.covariance + other.covariance)[np.ix_(shared, shared)])
    allowed = largest_by_chance(len(shared), chance)
    if not size <= allowed:  # nor where it is no number
        raise SensorsDisagree(
            f"{one.sensor} and {other.sensor} disagree on where the door stands: {other.sensor} has it "
            f"{_told(apart, shared)} from where {one.sensor} has it, {size:.1f} standard deviations, allowed are "
            f"{allowed:.1f}; clean door and sensors and start it again, then calibrate the sensor that is off",
            sensors=[one.sensor, other.sensor],
            deviations=size,
        )


def largest_by_chance(degrees: int, chance: float) -> float:
    """Length that a standard normal vector of so many degrees of freedom passes with a probability, 0 to 1.

    SciPy is imported here, and not by a bridge whose cell has one sensor.
    """
    from scipy.special import chdtri

    return float(np.sqrt(chdtri(degrees, chance)))


def _deviations(apart: FloatArray, covariance: FloatArray) -> float:
    """Mahalanobis length of a difference, shape (k,), by its covariance, shape (k, k); infinite by one that is none."""
    if not np.isfinite(covariance).all():
        return float("inf")
    try:
        return float(np.linalg.norm(np.linalg.solve(np.linalg.cholesky(covariance), apart)))
    except np.linalg.LinAlgError:
        return float("inf")


def _told(apart: FloatArray, shared: list[int]) -> str:
    """A difference, shape (k,) [m, rad], in words."""
    parts = [
        f"{DEGREES_OF_FREEDOM[i]} {m_to_mm(value):+.3f} mm"
        if i < 3
        else f"{DEGREES_OF_FREEDOM[i]} {rad_to_deg(value):+.4f} deg"
        for i, value in zip(shared, apart.tolist(), strict=True)
    ]
    return ", ".join(parts)
