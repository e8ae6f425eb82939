"""The robot under load along a plan: which joints bend, which way they turn, what that does to the tool."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.correction.compensate import Compensation, compensate
from doormill_ros.correction.felt import felt
from doormill_ros.correction.loads import Loads
from doormill_ros.correction.worth import DeflectionSpread, Worth, standing_share
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import (
    ComplianceModel,
    StandingModel,
    StandingSpread,
    remembers,
)


@dataclass(frozen=True, eq=False)
class LoadedRobot:
    """A robot that gives way under load, with its tool.

    Attributes:
        kinematics: Forward kinematics and Jacobian.
        model: How the robot gives way.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        tolerance: Accepted distance of the loaded tool from where it shall be [m].
        worth: Which share of a deflection is corrected; None corrects all of it.
    """

    kinematics: Kinematics
    model: ComplianceModel
    T_flange_tool: FloatArray
    tolerance: float = 1e-6
    worth: Worth | None = None

    @functools.cached_property
    def _standing_model(self) -> StandingModel | None:
        """The model, if it moves the unloaded tool; cached: the isinstance check costs more than most answers."""
        return self.model if isinstance(self.model, StandingModel) else None

    @functools.cached_property
    def remembers(self) -> bool:
        """Whether corrections hang on the directions of loads."""
        return remembers(self.model)

    @property
    def load_point(self) -> FloatArray:
        """Tool centre point in the flange frame, shape (3,) [m]."""
        return self.T_flange_tool[:3, 3]

    def deflection(self, q: FloatArray, wrench: FloatArray, direction: FloatArray) -> FloatArray:
        """Twist of the loaded tool, base axes; shapes (n, 6) each [rad], [N, N m], [-] -> [m, rad]."""
        return self.model.deflection(q, wrench, self.load_point, direction)

    def standing(self, q: FloatArray, direction: FloatArray) -> FloatArray:
        """Twist of the unloaded tool, base axes; shapes (n, 6) each [rad], [-] -> [m, rad]."""
        if self._standing_model is not None:
            return self._standing_model.standing(q, self.load_point, direction)
        return np.zeros((len(q), 6))

    def standing_spread(self, q: FloatArray) -> StandingSpread | None:
        """What is left to chance of it, joint angles of shape (n, 6) [rad]; None where there is nothing."""
        if self.worth is None or self._standing_model is None:
            return None
        return self._standing_model.standing_spread(q, self.load_point, self.worth.relative)

    def spread(
        self, worth: Worth, q: FloatArray, loads: Loads, standing: StandingSpread | None = None
    ) -> DeflectionSpread:
        """What is left to chance of the displacements by loads, in the wrenches that the model takes them to have.

        Args:
            worth: With the springs.
            q: Joint angles, shape (n, 6) [rad].
            loads: n loads.
            standing: Of the unloaded tool; None for the loads by themselves.
        """
        acting = felt(self.model, loads, q, self._axis)
        return worth.spread(q, acting.wrench, acting.spread, self.load_point, standing)

    def share(self, q: FloatArray, loads: Loads) -> FloatArray:
        """Share of each component of the deflections by the loads that is corrected, shape (n, 6).

        Args:
            q: Joint angles, shape (n, 6) [rad].
            loads: n loads.
        """
        if self.worth is None:
            return np.ones((len(q), 6))
        spread = self.spread(self.worth, q, loads)
        by_force = self.deflection(q, loads.wrench, loads.direction) - self.standing(q, loads.direction)
        return self.worth.share(by_force, spread, loads.bounded)

    def undone(self, q: FloatArray, loads: Loads) -> Callable[[FloatArray], FloatArray]:
        """What a correction undoes of the displacements of n loaded tools: of each part the share that it is worth.

        Args:
            q: Joint angles by which that share is told, shape (n, 6) [rad].
            loads: n loads.

        Returns:
            The twists, base axes, shape (n, 6) [m, rad], by joint angles near these, shape (n, 6) [rad].
        """
        share, own = self.share(q, loads), self._standing_share(q, loads.direction)

        def twist(angles: FloatArray) -> FloatArray:
            each = self.deflection(angles, loads.wrench, loads.direction) * share
            if self._standing_model is not None:
                each = each + self.standing(angles, loads.direction) * (own - share)
            return each

        return twist

    def posture(self, T_base_tool: FloatArray, q: FloatArray) -> FloatArray:
        """Joint angles that reach nominal poses unloaded, from angles near them.

        Args:
            T_base_tool: Poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].

        Returns:
            Shape (n, 6) [rad].
        """
        unloaded = np.zeros((len(q), 6))
        found = compensate(T_base_tool, q, lambda _: unloaded, self.kinematics, self.T_flange_tool, 1e-9)
        return found.q

    def corrected(self, T_base_tool: FloatArray, q: FloatArray, loads: Loads) -> Compensation:
        """Corrected poses of n stations, each under one load.

        Args:
            T_base_tool: Nominal poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].
            loads: n loads.
        """
        return self.corrected_for_all(T_base_tool, q, np.arange(len(q)), loads)

    def corrected_for_all(
        self, T_base_tool: FloatArray, q: FloatArray, owner: IntArray, loads: Loads
    ) -> Compensation:
        """Corrected poses of n targets, each for the mean of what its loads are worth to be corrected for.

        A target between two motions has one pose, but a load from either side; in the mean of
        the two the larger of the errors that remain is smallest.

        Args:
            T_base_tool: Nominal poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].
            owner: Target to which each load belongs, every target at least once, shape (e,).
            loads: e loads.
        """
        undone = self.undone(q[owner], loads)
        weight = 1.0 / np.bincount(owner, minlength=len(q))[owner, None]

        def deflect(angles: FloatArray) -> FloatArray:
            mean = np.zeros((len(angles), 6))
            np.add.at(mean, owner, undone(angles[owner]) * weight)
            return mean

        return compensate(T_base_tool, q, deflect, self.kinematics, self.T_flange_tool, self.tolerance)

    def corrected_again(
        self,
        found: Compensation,
        T_base_tool: FloatArray,
        q: FloatArray,
        owner: IntArray,
        loads: Loads,
        changed: BoolArray,
    ) -> Compensation:
        """As `corrected_for_all`, which found something where some of the loads were others.

        Args:
            found: What it found.
            T_base_tool: Nominal poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].
            owner: Target to which each load belongs, shape (e,).
            loads: e loads.
            changed: Which of them are others, shape (e,).
        """
        targets = np.unique(owner[changed])
        acting = np.isin(owner, targets)
        if not loads.wrench[acting].any():
            # A model may count in shares of the largest load, and there is none among these.
            return self.corrected_for_all(T_base_tool, q, owner, loads)
        place = np.searchsorted(targets, owner[acting])
        again = self.corrected_for_all(T_base_tool[targets], q[targets], place, loads.of(acting))
        return found.replaced(targets, again)

    def _axis(self, q: FloatArray) -> FloatArray:
        """Axis of the tool, base axes, shapes (n, 6) [rad] -> (n, 3)."""
        return (self.kinematics.forward(q) @ self.T_flange_tool)[:, :3, 2]

    def _standing_share(self, q: FloatArray, direction: FloatArray) -> FloatArray:
        """Share of the twists of the unloaded tool that is corrected, shape (n, 1)."""
        spread = self.standing_spread(q)
        if spread is None:
            return np.ones((len(q), 1))
        return standing_share(self.standing(q, direction), spread)[:, None]
