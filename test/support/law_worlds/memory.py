"""Laws that remember: every loading before counts, in the order of the clock."""

from __future__ import annotations

import numpy as np

from support.law_worlds.law import Law, any_joint, joint_or_link, of_hinge
from support.law_worlds.session import Session


def softening(rng: np.random.Generator, session: Session) -> Law:
    """Softer with every loading that it has carried, sound at the start."""
    hinge, power = joint_or_link(rng), float(rng.uniform(0.5, 1.5))
    whole = float(np.sum(np.abs(session.torque(hinge))))

    def felt(s: Session, torque: np.ndarray) -> np.ndarray:
        carried = np.concatenate([[0.0], np.cumsum(np.abs(torque))[:-1]])
        return torque * (carried / whole) ** power

    return of_hinge(
        "softening", hinge, "path", felt, 3.0, also=("time",), parameters={"power": power, "whole": whole}
    )


def play_steps(torque: np.ndarray, radii: np.ndarray, weights: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Turn of friction springs in parallel over a path of torques (Prandtl-Ishlinskii, a Preisach operator).

    Args:
        torque: The path, shape (n,) [N m].
        radii, weights: Friction torque [N m] and share of each element, shape (m,).
        start: State before the path, shape (m,) [N m].

    Returns:
        States after each step, shape (n, m) [N m]; their weighted sum times the compliance is the angle.
    """
    state, states = np.array(start, dtype=float), np.empty((len(torque), len(radii)))
    for i, now in enumerate(torque):
        state = np.maximum(now - radii, np.minimum(now + radii, state))
        states[i] = state
    return states * weights


def hysteresis(rng: np.random.Generator, session: Session) -> Law:
    """Friction springs that start from the side the joint came from and keep what each loading leaves.

    A motion wipes all memory but its direction. The load goes from zero to its value and back.
    """
    hinge = any_joint(rng)
    scale = float(rng.uniform(0.3, 1.0) * np.median(np.abs(session.torque(hinge))))
    radii = scale * np.array([0.1, 0.3, 0.6, 1.0])
    weights = np.full(4, 0.25)

    def felt(s: Session, torque: np.ndarray) -> np.ndarray:
        angle = np.empty(len(torque))
        side = s.approach[:, hinge.link - 1]
        for number in np.unique(s.stance):
            rows = np.flatnonzero(s.stance == number)
            path = np.column_stack([torque[rows], np.zeros(len(rows))]).ravel()
            start = -side[rows[0]] * radii  # at rest, pressed against the side that it came along
            ends = np.vstack([start * weights, play_steps(path, radii, weights, start)]).sum(axis=1)
            angle[rows] = ends[1::2] - ends[:-1:2]
        return angle

    return of_hinge(
        "hysteresis",
        hinge,
        "path",
        felt,
        3.0,
        also=("direction",),
        parameters={"radii": radii.tolist(), "weights": weights.tolist()},
    )
