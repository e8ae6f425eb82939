"""The stance of a robot that is likeliest by what the data say of turns under weight in any direction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares, nnls

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.fitting.fit import Fitted
from doormill_ros.diagnosis.pose.stance.free_weight import ARM, COMPLIANCE, DIRECTIONS, MASS, PARTS
from doormill_ros.robot_model.pose.link_masses import LinkMass
from doormill_ros.robot_model.pose.stance import Stance

#: Fall of the sum of squares that makes another stance worth a trial on rows left out.
TRIAL = 60.0
#: Times that a direction is sought from where the last search led.
ROUNDS = 3
_STRAIGHT = (0.0, 0.0, -1.0)


@dataclass(frozen=True, eq=False)
class Standing:
    """What the sag of the joints says of gravity and load.

    Attributes:
        stance: The stance.
        tilt: Angle between gravity and -z of the base, and its standard deviation [rad]; None where it is straight.
        mass: Of the load and its standard deviation [kg]; None where there is none.
    """

    stance: Stance
    tilt: tuple[float, float] | None = None
    mass: tuple[float, float] | None = None

    def simpler(self) -> list[Standing]:
        """The same with gravity along the nearest axis of the base: floor, wall or ceiling; none if that is upright."""
        axis = np.eye(3)[np.argmax(np.abs(self.stance.down))]
        down = np.sign(axis @ self.stance.down) * axis
        upright = bool(down @ _STRAIGHT > 0.0)
        if self.tilt is None or (upright and self.stance.load is None):
            return []
        tilt = None if upright else (float(np.arccos(-down[2])), self.tilt[1])
        return [replace(self, stance=replace(self.stance, down=down), tilt=tilt)]


class Weights:
    """What the data alone say of the coefficients of some free weights, which come first in a fit."""

    def __init__(self, free: Fitted, joints: int) -> None:
        self.joints = joints
        m = joints * DIRECTIONS * PARTS
        solution = free.solution
        scale = np.sqrt(solution.variance[:m])
        C = solution.covariance[:m, :m] / np.outer(scale, scale)
        # Less what was expected beforehand: the sizes of a direction that is not there say nothing of one that is.
        precision = np.linalg.inv(C) - np.eye(m)
        value, V = np.linalg.eigh(0.5 * (precision + precision.T))
        known = value > 1e-6
        root = np.sqrt(value[known])
        whole = np.linalg.solve(C, solution.x[:m] / scale)
        self.A = (root[:, None] * V[:, known].T) / scale
        self.y = (V[:, known].T @ whole) / root

    def asked(self, down: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compliances, shape (joints,) [rad / (N m)], none negative, and what is left, shape (m,).

        Args:
            down: Unit vector along gravity, shape (3,).
            load: Its mass [kg] and first moments about the flange [kg m], shape (4,).
        """
        unit = np.outer(down, np.concatenate([[1.0], load])).ravel()
        A = self.A.reshape(len(self.A), self.joints, -1) @ unit
        # Or a hair's tilt and a joint without any stiffness would explain what turns a joint that carries nothing.
        A = np.concatenate([A, np.eye(self.joints) / COMPLIANCE])
        y = np.concatenate([self.y, np.zeros(self.joints)])
        size = np.linalg.norm(A, axis=0)
        c = nnls(A / size, y)[0] / size
        return c, A @ c - y


def likeliest(weights: Weights) -> Standing | None:
    """The simplest stance that is far likelier than being upright; None for that."""
    upright = _cost(weights, np.array(_STRAIGHT), np.zeros(4))
    best: tuple[float, Standing] | None = None
    for tilted, loaded in ((True, False), (False, True), (True, True)):
        found = _fitted(weights, tilted, loaded)
        least = upright - TRIAL if best is None else best[0] - TRIAL * (tilted and loaded)
        if found is not None and found[0] < least:
            best = found
    return None if best is None else best[1]


def _cost(weights: Weights, down: FloatArray, load: FloatArray) -> float:
    return float(np.sum(weights.asked(down, load)[1] ** 2))


def _fitted(weights: Weights, tilted: bool, loaded: bool) -> tuple[float, Standing] | None:
    """Sum of squares and stance, the best from gravity along each axis of the base."""
    straight = np.array(_STRAIGHT)
    starts = [np.array(one) for one in (straight, *np.eye(3), *-np.eye(3)[:2])] if tilted else [straight]
    best: tuple[float, FloatArray, FloatArray, FloatArray] | None = None
    for start in starts:
        down, load = start, np.zeros(4)
        # Anew about where it led to: half of all directions are farther than any step.
        for _ in range(ROUNDS):
            cost, down, load, std = _near(weights, down, load, tilted, loaded)
        if best is None or cost < best[0] * (1.0 - 1e-9):
            best = cost, down, load, std
    assert best is not None
    cost, down, load, std = best
    mass = float(load[0])
    if loaded and not (0.0 < mass < 10.0 * MASS and np.linalg.norm(load[1:]) < 2.0 * ARM * mass):
        return None
    standing = Standing(
        Stance(down, LinkMass(mass, load[1:] / mass) if loaded else None),
        (float(np.arccos(np.clip(-down[2], -1.0, 1.0))), float(np.hypot(*std[:2]))) if tilted else None,
        (mass, float(std[2 * tilted])) if loaded else None,
    )
    return cost, standing


def _near(
    weights: Weights, down: FloatArray, load: FloatArray, tilted: bool, loaded: bool
) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Sum of squares, gravity, load and standard deviations of what was free, from a gravity (3,) and a load (4,)."""
    unit = np.array([MASS, *[MASS * ARM] * 3]) / 10.0
    across = np.linalg.svd(down[None])[2][1:]  # two directions at right angles

    def parts(p: FloatArray) -> tuple[FloatArray, FloatArray]:
        turned = down + (p[:2] @ across if tilted else 0.0)
        return turned / np.linalg.norm(turned), unit * p[2 * tilted :] if loaded else load

    found = least_squares(
        lambda p: weights.asked(*parts(p))[1],
        np.concatenate([np.zeros(2 * tilted), load / unit if loaded else np.zeros(0)]),
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=50,
    )
    std = np.sqrt(np.maximum(np.diag(np.linalg.pinv(found.jac.T @ found.jac)), 0.0))
    std[2 * tilted :] *= unit[: len(std) - 2 * tilted]
    return 2.0 * float(found.cost), *parts(found.x), std
