"""A cell that moves a little while a series is recorded: the robot warms up, the tracker's stand settles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import direction
from doormill_ros.robot_model.pose.view import SetView

#: Waves over the recording, and decay lengths of a warm-up as shares of the recording.
WAVES = (1, 2, 3, 4)
DECAYS = (0.03, 0.12)
_AXES = ("x", "y", "z", "turn_x", "turn_y", "turn_z")


class PoseDrift(PoseCause):
    """Slow displacement of the robot's base against the tracker within one series."""

    name = "thermal_drift"
    of_robot = False

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """On every series of which nothing simpler is known: 'set NAME'."""
        if not hints.drift:
            return []
        return [cls(f"set {data.name}") for i, data in enumerate(hints.sets) if i not in hints.known]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Amplitudes of the waves and decays in every direction."""
        shapes = [f"wave_{k}" for k in WAVES] + [f"warm_up_{i + 1}" for i in range(len(DECAYS))]
        return tuple(
            Coefficient(f"{axis}_{shape}", unit, f"drift {self.where} {unit} {shape}", typical)
            for axis, (unit, typical) in zip(_AXES, [("m", 1e-4)] * 3 + [("rad", 1e-4)] * 3, strict=True)
            for shape in shapes
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Displacement of the base."""
        if f"set {view.name}" != self.where:
            return []
        order = view.order[:, None]
        basis = np.concatenate(
            [np.cos(np.pi * order * np.array(WAVES)), np.exp(-order / np.array(DECAYS))], axis=1
        )
        basis = basis - basis.mean(axis=0)
        return [Columns(direction(0, axis), axis * basis.shape[1], basis) for axis in range(6)]

    def pattern(self) -> str:
        """What it leaves."""
        return "the residual of all poses moves slowly together while the series is recorded"
