"""Write down the steps of one operation: from in front of the feature, through the wood, and back in front of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.features.base import CLEARING, PLUNGE
from doormill_ros.toolpath.curves.curve import Curve, Line
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.units import deg_to_rad

ABOVE_FLOOR = 0.002  #: where the way down changes from rapid to plunge feed [m]
NEAR = 1e-9  #: two places are one [m]
SHARP = deg_to_rad(5.0)  #: the tool stops at a corner of the wall pass sharper than this


class CutWriter:
    """The steps of one operation as they come; for subclasses that know where to cut.

    Args:
        operation: What to mill.
        settings: Clearance and speeds.

    Attributes:
        result: What is written down.
        at: Where the tool stands, door frame, shape (3,) [m].
        inward: Into the wood, door frame, shape (3,).
        feed: Of cuts [m/s].
        plunge_feed: Of ways down [m/s].
    """

    def __init__(self, operation: Operation, settings: PathSettings) -> None:
        self.operation = operation
        self.feature = operation.feature
        self.settings = settings
        self.approach = settings.approach
        cutting = self.feature.cutting
        self.feed = cutting.feed_rate(self.feature.tool)
        self.plunge_feed = cutting.plunge(self.feature.tool)
        self.pattern = Step(
            MotionKind.LINEAR,
            Line(np.zeros(3), np.zeros(3)),
            operation.R_door_tool,
            self.feed,
            feature=self.feature.id,
            spindle_speed=cutting.spindle(self.feature.tool),
        )
        self.inward = operation.T_door_feature[:3, 2]
        self._loads: dict[str, dict[str, Any]] = {}
        self.result: list[Step] = []
        self.at: FloatArray = operation.T_door_feature[:3, 3]

    def _ramp(self, curves: Sequence[Curve], slope: float) -> None:
        """Along curves down into the wood, no faster down than the plunge feed."""
        begin = curves[0].start
        if self.result:
            self._line(begin, cutting=True, name=CLEARING)
        else:
            self._line_in(begin)
        speed = min(self.feed, self.plunge_feed / math.sin(slope))
        for curve in curves:
            self._cut(curve, PLUNGE, False)
            self.result[-1] = self.result[-1].changed(speed=speed)

    def _line_in(self, point: FloatArray) -> None:
        """From in front of the surface to a place just above it."""
        below = float((point - self.operation.T_door_feature[:3, 3]) @ self.inward)
        front = point - (below + self.approach.clearance) * self.inward
        self.at = front
        self._line(front, speed=self.approach.rapid_speed, zone="fine")
        self._line(point, speed=self.approach.plunge_speed)

    def _go(self, point: FloatArray, depth: float, floor: float) -> None:
        """To the start of a contour: through the cleared part of the pocket, or from in front."""
        if not self.result:
            front = point - (depth + self.approach.clearance) * self.inward
            above = point - (depth - floor + ABOVE_FLOOR) * self.inward
            self.at = front
            self._line(front, speed=self.approach.rapid_speed, zone="fine")
            self._line(above, speed=self.approach.plunge_speed)
            self._line(point, speed=self.plunge_feed, zone="fine", cutting=True, name=PLUNGE)
            return
        down = (point - self.at) @ self.inward
        self._line(point - down * self.inward, cutting=True, name=CLEARING)
        if down > 1e-9:
            self._line(point, speed=self.plunge_feed, zone="fine", cutting=True, name=PLUNGE)

    def _line(
        self,
        end: FloatArray,
        speed: float | None = None,
        zone: str = "z0",
        cutting: bool = False,
        name: str = "",
    ) -> None:
        if self.result and np.linalg.norm(end - self.at) < 1e-9:
            return
        self.result.append(
            self.pattern.changed(
                curve=Line(self.at, end),
                speed=speed or self.feed,
                zone=zone,
                cutting=cutting,
                **self._load(name if cutting else None),
            )
        )
        self.at = end

    def _cut(self, curve: Curve, name: str | None, wall: bool) -> None:
        kind = MotionKind.CIRCULAR if curve.is_arc else MotionKind.LINEAR
        self.result.append(
            self.pattern.changed(kind=kind, curve=curve, cutting=True, wall=wall, **self._load(name))
        )
        self.at = curve.end

    def _load(self, name: str | None) -> dict[str, Any]:
        """What the recipe says of the force on a segment; None for a cut under none."""
        if name is None:
            return {}
        if name not in self._loads:
            feature = self.feature
            self._loads[name] = {
                "wrench_tool": feature.wrench(name),
                "std_tool": feature.wrench_std(name),
                "bounded": not feature.force_origin.measured,
                "kind_of_feature": feature.kind,
            }
        return self._loads[name]

    def _mark_corners(self) -> None:
        """Stop at sharp corners of the wall pass: a fly-by would leave wood in them."""
        for i in range(len(self.result) - 1):
            step, after = self.result[i], self.result[i + 1]
            if step.wall and after.wall:
                turn = step.curve.tangent(1.0) @ after.curve.tangent(0.0)
                if turn < math.cos(SHARP):
                    self.result[i] = step.changed(zone="fine")

    def _retract(self, depth: float) -> None:
        # The last cut must end where it ends before the tool is drawn out.
        self.result[-1] = self.result[-1].changed(zone="fine")
        front = self.at - (depth + self.approach.clearance) * self.inward
        self._line(front, speed=self.approach.rapid_speed)
