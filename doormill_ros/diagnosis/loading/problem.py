"""One measurement set made ready for fitting: geometry, noise, folds, and what any set of causes predicts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.fitting.problem import Prediction, make_folds, split
from doormill_ros.diagnosis.core.words.margin import Check
from doormill_ros.diagnosis.core.words.wording import METRES
from doormill_ros.diagnosis.loading.hidden_states import (
    HiddenEffect,
    hidden_effect,
    read_states,
    total,
    undecided,
)
from doormill_ros.diagnosis.loading.observation import (
    carried,
    displacement_noise,
    observed,
    trackers_of,
    whitening,
)
from doormill_ros.diagnosis.loading.patterns import unnamed_patterns
from doormill_ros.diagnosis.loading.suspicion import halves, turning
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, Setup
from doormill_ros.robot_model.elastic.causes.registry import candidates
from doormill_ros.robot_model.elastic.circumstances import Circumstances
from doormill_ros.robot_model.elastic.load_case import LoadCase, build_load_case

#: Difference between first-order and finite joint angles, in noise floors, from which both are tried.
CURVED = 0.3
#: Trials from which on a cause may be named: some number of the library fits the components of any fewer.
FEWEST = 6


class LoadingProblem:
    """Predicts the trials of one set from any list of causes.

    Attributes:
        data: The set.
        case: Loads and geometry without any cause.
        folds: Fold of each trial, shape (n,).
        whiten: Inverse Cholesky factors of the noise covariance, shape (n, 3, 3).
        noise_floor: Root mean square of the propagated noise over all components [m].
        curvature: What finite joint angles would add to the springs, shape (n, 3) [m].
    """

    unit = METRES
    resolution = 0.0

    def __init__(
        self,
        data: Trials,
        finite: bool = False,
        sight: FloatArray | None = None,
        groups: IntArray | None = None,
        allowed: Callable[[ElasticCause], bool] = lambda cause: True,
    ) -> None:
        """Compute geometry and the noise of every trial.

        Args:
            data: The set.
            finite: Whether the springs turn the joints by finite angles instead of to first order.
            sight: Unit vectors along which alone displacement was measured, shape (n, 3); None for all
                three components.
            groups: What is left out together, shape (n,); None for configurations.
            allowed: Which causes of the library can act in these trials.
        """
        self.data, self.finite, self.sight, self.allowed = data, finite, sight, allowed
        self.components = 3 if sight is None else 1
        self.kinematics = Kinematics(data.dh)
        self._position, self._link = data.reflector_position, data.reflector_link
        self.case = self._build(Setup(), None)
        self.whiten, variance = whitening(displacement_noise(self.case, data), sight)
        self.noise_floor = float(np.sqrt(variance.mean()))
        self.configuration = data.configuration if groups is None else np.asarray(groups)
        self.folds = make_folds(self.configuration)
        self.curvature = self.case.curvature()

    def __len__(self) -> int:
        return len(self.data)

    def candidates(self) -> list[ElasticCause]:
        """Every cause at every place where it can act, and the patterns without a name; none for too few trials."""
        data = self.data
        if len(data) < FEWEST:
            return []
        library = candidates(dict.fromkeys(data.reflector.tolist()))
        patterns = unnamed_patterns(data.q, data.time, data.temperature, data.dt)
        return [*(cause for cause in library if self.allowed(cause)), *patterns]

    @property
    def curved(self) -> bool:
        """Whether finite joint angles differ from first order by more than the noise."""
        return bool(np.sqrt(np.mean(self.curvature**2)) > CURVED * self.noise_floor)

    def bent(self) -> Self | None:
        """The same with finite joint angles, where these differ from first order by more than the noise."""
        return self.with_angles(True) if self.curved else None

    def with_angles(self, finite: bool) -> Self:
        """The same with finite joint angles, or to first order."""
        return type(self)(self.data, finite, self.sight, self.configuration, self.allowed)

    def cuts(self) -> dict[str, BoolArray]:
        """Small and large loads, early and late, each joint's angle and torque, each reflector; shape (n,)."""
        return halves(self.data, self.case)

    def groupings(self) -> Sequence[IntArray]:
        """Configurations and reflectors, shape (n,) each."""
        return self.configuration, np.unique(self.data.reflector, return_inverse=True)[1]

    def objections(
        self, members: Sequence[ElasticCause], theta: FloatArray, cause: ElasticCause
    ) -> Sequence[Check]:
        """As `Examined.objections`: nothing beside all that holds for any kind of data."""
        return ()

    def turning(self, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
        """The joint that trials marked gross, shape (n,), point along most, and its chance; none along one sight."""
        return turning(self.case, self.whiten, residual, gross) if self.components == 3 else ("", 1.0)

    def labels(self) -> IntArray:
        """Trial numbers, shape (n,)."""
        return self.data.trial

    def _build(self, setup: Setup, largest_torque: FloatArray | None) -> LoadCase:
        data, position = self.data, self._position
        if setup.reflector_offset:
            position = position.copy()
            for name, offset in setup.reflector_offset.items():
                position[data.reflector == name] += offset
        return build_load_case(
            self.kinematics,
            data.q + setup.joint_offset,
            data.wrench * setup.wrench_gain,
            data.load_point,
            wrench_rotation=data.wrench_frame_rotation + setup.wrench_angle,
            points=position,
            links=self._link,
            direction=data.direction,
            joint_stiffness=data.joint_stiffness,
            noise=(data.noise.force, data.noise.torque),
            largest_torque=largest_torque,
            circumstances=Circumstances(data.time, data.dt, data.temperature, data.reflector),
        )

    def measured_part(self, white: FloatArray) -> FloatArray:
        """Residual in metres, shape (n, 3), of a whitened one; along the sight where there is one."""
        if self.sight is None:
            return np.asarray(np.linalg.solve(self.whiten, white[:, :, None])[:, :, 0], dtype=float)
        size: FloatArray = white[:, 0] / np.linalg.norm(self.whiten[:, 0], axis=1)
        return size[:, None] * self.sight

    def case_of(self, members: Sequence[ElasticCause], theta: FloatArray) -> LoadCase:
        """Geometry and loads after the causes, sized by theta, shape (p,), that act before the elasticity."""
        parts = split(members, theta)
        if not any(cause.stage == "setup" for cause in members):
            return self.case
        setup = Setup()
        for cause, part in parts:
            cause.setup(setup, part)
        return self._build(setup, self.case.largest_torque)

    def _elastic(
        self, members: Sequence[ElasticCause], theta: FloatArray, case: LoadCase
    ) -> tuple[FloatArray, list[HiddenEffect]]:
        """Certain displacement (n, 3), and what each hidden cause adds where it acts."""
        total = case.springs()[:, :3]
        if self.finite:
            total = total + case.curvature()
        hidden = []
        for cause, part in split(members, theta):
            if cause.stage != "robot":
                continue
            twist = cause.twist(case, part)[:, :3]
            chance = cause.hidden_state(case)
            if chance is None:
                total = total + twist
            else:
                hidden.append(hidden_effect(chance, twist, cause.hidden_sign(case)))
        return total, hidden

    def predict(
        self, members: Sequence[ElasticCause], theta: FloatArray, derivative: bool = False
    ) -> Prediction:
        """Residuals, likelihood and derivatives of a model.

        Args:
            members: Causes that act.
            theta: Their fitted numbers in a row, shape (p,).
            derivative: Whether the Jacobian is wanted.
        """
        case = self.case_of(members, theta)
        certain, hidden = self._elastic(members, theta, case)
        read_states(
            hidden,
            lambda others: self.data.displacement - observed(members, theta, self.data.dt, certain + others),
            self.whiten,
        )
        inner = certain + total(hidden, len(self))
        residual = self.data.displacement - observed(members, theta, self.data.dt, inner)
        white = np.einsum("nij,nj->ni", self.whiten, residual)
        cost = np.sum(white**2, axis=1)
        for h in hidden:
            cost = cost + undecided(h, self.whiten)
        if not derivative:
            return Prediction(residual, white, cost)
        jacobian, spread = self._derivative(members, theta, case, inner, hidden)
        return Prediction(residual, white, cost, jacobian, spread)

    def slope(self, cause: ElasticCause, theta: FloatArray) -> FloatArray:
        """Whitened derivative of the prediction by one cause alone, shape (n, 3, p)."""
        if cause.stage == "robot" and cause.hidden_state(self.case) is None:
            return self.whiten @ cause.derivative(self.case, theta)[:, :3]
        return self.predict([cause], theta, derivative=True).derived

    def _derivative(
        self,
        members: Sequence[ElasticCause],
        theta: FloatArray,
        case: LoadCase,
        inner: FloatArray,
        hidden: list[HiddenEffect],
    ) -> tuple[FloatArray, tuple[FloatArray, FloatArray] | None]:
        n, dt = len(self), self.data.dt
        columns = np.zeros((n, 3, len(theta)))
        spread: tuple[FloatArray, FloatArray] | None = None
        trackers = trackers_of(members, theta)
        at, h = 0, 0
        for cause, part in split(members, theta):
            block = slice(at, at + cause.size)
            at += cause.size
            if cause.stage == "robot":
                slope = cause.derivative(case, part)[:, :3]
                if cause.hidden_state(case) is not None:
                    slope, rows = hidden[h].slopes(slope)
                    if rows is not None:
                        every = np.zeros((n, 3, len(theta)))
                        every[:, :, block] = rows[1]
                        spread = (
                            (rows[0], every) if spread is None else (spread[0] + rows[0], spread[1] + every)
                        )
                    h += 1
                columns[:, :, block] = carried(trackers, slope)
            elif cause.stage == "tracker":
                before, place = inner, [c is cause for c, _ in trackers].index(True)
                for earlier, its_part in trackers[:place]:
                    before = earlier.observe(before, dt, its_part)
                slope = cause.observe_derivative(before, dt, part)
                columns[:, :, block] = carried(trackers[place + 1 :], slope)
            else:
                columns[:, :, block] = self._setup_slope(members, theta, block, hidden, inner)
        jacobian = self.whiten @ columns
        if spread is not None:
            spread = (np.einsum("nij,nj->ni", self.whiten, spread[0]), self.whiten @ spread[1])
        return jacobian, spread

    def _setup_slope(
        self,
        members: Sequence[ElasticCause],
        theta: FloatArray,
        block: slice,
        hidden: list[HiddenEffect],
        inner: FloatArray,
    ) -> FloatArray:
        """One forward difference a number: the posture enters through the whole chain."""
        before = observed(members, theta, self.data.dt, inner)
        slopes = []
        for i in range(block.start, block.stop):
            step = 1e-5
            moved = theta.copy()
            moved[i] += step
            after, again = self._elastic(members, moved, self.case_of(members, moved))
            for old, new in zip(hidden, again, strict=True):
                after = after + (old.state * old.sign)[:, None] * new.effect
            slopes.append((observed(members, moved, self.data.dt, after) - before) / step)
        return np.stack(slopes, axis=2)


#: What is known of a robot that was loaded.
LoadingDiagnosis = Diagnosis[LoadingProblem, ElasticCause]
