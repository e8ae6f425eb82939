"""What was not recorded: whether a cause acted in a trial, and which way, read from the trial itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray

#: Pairs of (inverse Cholesky factor, displacement) to whitened displacement.
_WHITE = "nij,nj->ni"


@dataclass(eq=False)
class HiddenEffect:
    """A cause of which it is not known where it acts.

    Attributes:
        chance: Probability that it acts in each trial before anything was measured, shape (n,).
        effect: Displacement where it does, shape (n, 3) [m].
        odds: Log odds that the effect has this sign and not the opposite one, shape (n,); infinite
            where that is certain.
        state: Probability that it acts, given the measurement, shape (n,).
        sign: The likelier sign, given the measurement, shape (n,).
    """

    chance: FloatArray
    effect: FloatArray
    odds: FloatArray
    state: FloatArray
    sign: FloatArray

    @property
    def unsure(self) -> BoolArray:
        """Trials in which it may or may not act, shape (n,)."""
        return (self.chance > 0.0) & (self.chance < 1.0)

    @property
    def expected(self) -> FloatArray:
        """Expected displacement, shape (n, 3) [m]."""
        return self.state[:, None] * self.effect

    def slopes(self, slope: FloatArray) -> tuple[FloatArray, tuple[FloatArray, FloatArray] | None]:
        """Derivative of what is expected, and pseudo-rows for what is undecided.

        Args:
            slope: Derivative of the effect where it acts, shape (n, 3, p).

        Returns:
            Shape (n, 3, p); rows, shape (n, 3), and their derivative, shape (n, 3, p), None where all is decided.
        """
        slope = self.sign[:, None, None] * slope
        width = np.sqrt(np.clip(self.state * (1.0 - self.state), 0.0, None))
        rows = (-width[:, None] * self.effect, width[:, None, None] * slope) if np.any(width > 1e-6) else None
        return self.state[:, None, None] * slope, rows


def hidden_effect(chance: FloatArray, effect: FloatArray, odds: FloatArray | None) -> HiddenEffect:
    """A hidden effect, shape (n, 3), before its trials were looked at; chance and odds have shape (n,)."""
    n = len(chance)
    return HiddenEffect(
        chance,
        effect,
        np.full(n, np.inf) if odds is None else odds,
        np.array(chance, dtype=float),
        np.ones(n),
    )


def total(hidden: Sequence[HiddenEffect], n: int) -> FloatArray:
    """Expected displacement of all, shape (n, 3) [m]."""
    return sum((h.expected for h in hidden), np.zeros((n, 3)))


def read_states(
    hidden: Sequence[HiddenEffect],
    residual: Callable[[FloatArray], FloatArray],
    whiten: FloatArray,
) -> None:
    """Set state and sign of every effect from the trials.

    Args:
        hidden: Changed in place; an effect of the other sign is turned round.
        residual: Measured minus simulated displacement with a given sum of the other hidden effects added.
        whiten: Shape (n, 3, 3).
    """
    if not any(h.unsure.any() for h in hidden):
        return
    n = len(whiten)
    for _ in range(1 if len(hidden) == 1 else 3):
        for h in hidden:
            rows = h.unsure
            others = total([other for other in hidden if other is not h], n)
            closed = np.einsum(_WHITE, whiten[rows], residual(others)[rows])
            acting = np.einsum(_WHITE, whiten[rows], h.effect[rows])
            doubt = np.isfinite(h.odds[rows])
            turned = doubt & (2.0 * np.sum(closed * acting, axis=1) < -h.sign[rows] * h.odds[rows])
            turn = np.where(turned, -1.0, 1.0)
            h.effect[rows] *= turn[:, None]
            h.sign[rows] *= turn
            acting = acting * turn[:, None]
            odds = np.sum(closed * acting, axis=1) - 0.5 * np.sum(acting**2, axis=1)
            odds += np.log(h.chance[rows] / (1.0 - h.chance[rows]))
            h.state[rows] = 1.0 / (1.0 + np.exp(-np.clip(odds, -500.0, 500.0)))


def undecided(h: HiddenEffect, whiten: FloatArray) -> FloatArray:
    """What an unknown state adds to -2 log likelihood, shape (n,): its spread, and the information that chose it."""
    s, r = np.clip(h.state, 1e-300, 1.0), np.clip(1.0 - h.state, 1e-300, 1.0)
    p = np.where(h.unsure, h.chance, 0.5)
    information = 2.0 * (h.state * np.log(s / p) + (1.0 - h.state) * np.log(r / (1.0 - p)))
    spread = h.state * (1.0 - h.state) * np.sum(np.einsum(_WHITE, whiten, h.effect) ** 2, axis=1)
    return np.where(h.unsure, information + spread, 0.0)
