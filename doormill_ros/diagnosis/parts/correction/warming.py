"""What doors told of a cell that warms up, as a law for the doors to come."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.parts.effects.registry import REST
from doormill_ros.diagnosis.parts.effects.shift import ArmWarming, Warming
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.robot_model.warmth.growth import GrowthLaw, ThermalGrowth
from doormill_ros.units import UM, hours_to_s

LEAST = 0.01  #: probability below which a time constant is no part of the law


def warmed(finding: Finding[InTime]) -> bool:
    """Whether it is a growth that a law in time undoes: nothing else would explain the doors as well."""
    return isinstance(finding.cause.effect, Warming) and not finding.confusable


@lru_cache(maxsize=1)  # a fit for each time constant, wanted by the model and by what it would change
def growth_told(diagnosis: DoorDiagnosis) -> ThermalGrowth | None:
    """The law of the growth that is named; None where none is, or something else would do as well.

    Time constants are weighed by how well the doors come out with each, everything else fitted anew beside it.
    """
    cause = next((finding.cause for finding in diagnosis.findings if warmed(finding)), None)
    if cause is None:
        return None
    problem, found = diagnosis.problem, diagnosis.extended
    where, arm = found.part(cause).start, isinstance(cause.effect, ArmWarming)
    noise = max(1.0, float(np.mean(found.prediction.cost[found.weights > 0.0])) / problem.components)
    fits = []
    for hours in REST:
        warming = ArmWarming(hours) if arm else Warming(hours)
        members = [InTime(warming) if member is cause else member for member in found.members]
        fits.append(fit(problem, members, [found.theta]))
    score = np.array([one.score for one in fits])
    weight = np.exp(-0.5 * (score - score.min()) / noise)
    weight /= weight.sum()
    kept = weight >= LEAST
    laws = []
    for i in np.flatnonzero(kept):
        size = UM * fits[i].theta[where]
        std = UM * np.sqrt(noise * fits[i].covariance[where, where])
        laws.append(GrowthLaw(REST[i], float(size), float(std), float(weight[i] / weight[kept].sum())))
    times = [door.time for door in problem.doors]
    takt = float(np.median(np.diff(times)))
    return ThermalGrowth(tuple(laws), (times[-1] - times[0]) / hours_to_s(1.0), takt, arm)
