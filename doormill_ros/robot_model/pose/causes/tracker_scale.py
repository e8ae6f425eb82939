"""A tracker that has all lengths too long or too short by the same share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause, Reported
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import Placement, direction
from doormill_ros.robot_model.pose.view import SetView
from doormill_ros.units import share_to_ppm


class PoseTrackerScale(PoseCause):
    """Reported position = factor times true position.

    To poses this is the same as a robot all of whose lengths are off by one share, and no other measure of length than
    the tracker's is at hand: it stays in the robot's model, as the lengths of links would.
    """

    name = "tracker_scale"
    drawn_wrong = True
    for_lengths = True

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """One, where one share stands for the lengths of several links."""
        return [cls("tracker")] if hints.scaled else []

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """How far the factor is from 1."""
        return (Coefficient("factor", "1", "tracker scale", 1e-3),)

    def columns(self, view: SetView) -> list[Columns]:
        """Displacement of the flange away from the base; a placement tells those of the base and of the target."""
        flange = view.T_base_frames[:, -1, :3, 3]
        return [Columns(direction(0, axis), 0, flange[:, axis : axis + 1]) for axis in range(3)]

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """The factor."""
        factor = super().reported(x, std, seen)["factor"]
        return {"factor": {**factor, "value": 1.0 + factor["value"]}}

    def doubt(self, reported: Mapping[str, Mapping[str, Any]]) -> str:
        """What one share may be, by which all lengths are off."""
        factor = reported["factor"]
        return (
            "One share explains what otherwise lengths of several links would: all lengths are seen "
            f"{share_to_ppm(factor['value'] - 1.0):+.0f} ppm off (standard deviation "
            f"{share_to_ppm(factor['std']):.0f} ppm). The tracker's scale does that, and so does a "
            "robot that is warmer or colder than its drawing; poses do not tell them apart. Measure a scale bar of "
            "known length with the tracker."
        )

    def pattern(self) -> str:
        """What it leaves."""
        return "the residual of every pose points away from one point, in proportion to the distance"
