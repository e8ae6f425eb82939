"""Lengths and angles of a link that differ from the drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import direction
from doormill_ros.robot_model.pose.view import SetView

#: Joint axes within this angle count as parallel: Hayati's angle beta replaces the offset d [rad].
PARALLEL = 0.05
#: Parameters that are lengths.
LENGTHS = ("d", "a")
_UNITS = {"theta": "rad", "d": "m", "a": "m", "alpha": "rad", "beta": "rad"}


class LinkGeometry(PoseCause):
    """Errors of theta, d, a, alpha of a link; of theta, a, alpha, beta between parallel axes (Hayati 1983).

    Theta and d of link 1 and everything of the last link are the same as a displaced robot or target: they belong
    to the placement and are not fitted.

    Attributes:
        names: Parameters that are fitted.
        hidden: Those that a placement tells.
        drawn: Lengths that are as drawn, but for a scale of everything.
    """

    name = "link_geometry"
    drawn_wrong = True

    def __init__(self, where: str, dh: FloatArray, drawn: Sequence[str] = ()) -> None:
        """Choose what can be told from the placement."""
        super().__init__(where)
        k = number(where)
        parallel = k < len(dh) and abs(np.sin(dh[k - 1, 3])) < PARALLEL
        names = ("theta", "a", "alpha", "beta") if parallel else ("theta", "d", "a", "alpha")
        self.hidden = {1: ("theta", "d"), len(dh): names}.get(k, ())
        self.drawn = tuple(drawn)
        self.names = tuple(name for name in names if name not in (*self.hidden, *drawn))

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """Every link but the last, which is the same as a displaced target."""
        return [cls(f"link {k}", hints.sets[0].dh) for k in range(1, hints.sets[0].joints)]

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any], dh: FloatArray) -> PoseCause:
        """With the model's table."""
        return cls(where, dh, settings.get("drawn", ()))

    @property
    def settings(self) -> dict[str, Any]:
        """Lengths that are as drawn, where there are any."""
        return {"drawn": list(self.drawn)} if self.drawn else {}

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Offsets and angles."""
        return tuple(
            Coefficient(name, _UNITS[name], f"link_geometry {_UNITS[name]}", 2e-3) for name in self.names
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Constant displacements of the link's frames."""
        k = number(self.where)
        where = {
            "theta": direction(k - 1, 5),
            "d": direction(k - 1, 2),
            "a": direction(k, 0),
            "alpha": direction(k, 3),
            "beta": direction(k, 4),
        }
        one = np.ones((len(view.q), 1))
        return [Columns(where[name], i, one) for i, name in enumerate(self.names)]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual moves rigidly with {self.where}, in every posture alike"
