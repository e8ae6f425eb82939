"""A tracker that has all lengths too long or too short by the same share."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import direction
from doormill_ros.robot_model.pose.view import SetView


class PoseTrackerScale(PoseCause):
    """Reported position = factor times true position.

    To poses this is the same as a robot all of whose lengths are off by one share, and no other measure of length than
    the tracker's is at hand: it stays in the robot's model, as the lengths of links would.
    """

    name = "tracker_scale"

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

    def pattern(self) -> str:
        """What it leaves."""
        return "the residual of every pose points away from one point, in proportion to the distance"
