"""A model of a robot while its cell is so and so warm."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel, StandingSpread
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel
from doormill_ros.robot_model.gravity.model import Sag, SaggingModel
from doormill_ros.robot_model.warmth.growth import REACH, ThermalGrowth


def growth_in(model: ComplianceModel) -> ThermalGrowth | None:
    """How a model's tool comes forward as the cell warms up; None where it tells nothing of that."""
    inner = model.springs if isinstance(model, SaggingModel) else model
    return inner.growth if isinstance(inner, ExtendedComplianceModel) else None


class GrownTool:
    """A tool that stands farther from the base (implements what `SaggingModel` asks of a sag)."""

    def __init__(
        self, kinematics: Kinematics, way: float, std: float, arm: bool, sag: Sag | None = None
    ) -> None:
        """Take how far and how sure that is [m], what grows, and what else moves the tool without load."""
        self._kinematics, self._way, self._std, self._arm, self._sag = kinematics, way, std, arm, sag

    def twist(self, q: FloatArray, point: FloatArray) -> FloatArray:
        """Of the tool; shapes (n, 6) [rad], (3,) [m] -> (n, 6) [m, rad]."""
        T = self._kinematics.forward(q)
        flange = T[:, :3, 3]
        place = T[:, :3, :3] @ point + flange
        away = flange / REACH if self._arm else place / np.linalg.norm(place, axis=1, keepdims=True)
        found = np.zeros((len(q), 6)) if self._sag is None else self._sag.twist(q, point)
        found[:, :3] += self._way * away
        return found

    def spread(self, q: FloatArray, point: FloatArray, relative: FloatArray) -> StandingSpread:
        """How well that is known, as `Sag.spread`."""
        if self._sag is None:
            return StandingSpread(np.zeros((len(q), 6, 3)), np.full(len(q), self._std))
        sag = self._sag.spread(q, point, relative)
        return StandingSpread(sag.joints, np.hypot(sag.rest, self._std))


def grown(
    model: ComplianceModel, kinematics: Kinematics, growth: ThermalGrowth, way: float, std: float
) -> SaggingModel:
    """A model with its tool so far from where it stands in the cold.

    Args:
        model: In the cold.
        kinematics: Of its robot.
        growth: What grows.
        way: How far it has come, away from the base [m].
        std: Its standard deviation [m].
    """
    springs, sag = (model.springs, model.sag) if isinstance(model, SaggingModel) else (model, None)
    return SaggingModel(springs, GrownTool(kinematics, way, std, growth.arm, sag))
