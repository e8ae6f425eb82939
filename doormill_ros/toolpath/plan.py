"""The nominal path on the door, before any robot: what is milled in which order."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.toolpath.curves.curve import Curve
from doormill_ros.toolpath.program import MotionKind


@dataclass(frozen=True, eq=False)
class Step:
    """One motion of the tool centre point, in the door frame.

    Attributes:
        kind: MoveAbsJ, MoveL or MoveC.
        curve: Path of the tool centre point; for a MoveAbsJ only its end counts, the posture there is a point of joint
            space and no target.
        R_door_tool: Orientation of the tool, shape (3, 3).
        speed: Speed of the tool centre point [m/s].
        zone: RAPID zone at the end.
        feature: Feature of the recipe, empty between features.
        cutting: True while the tool is in the wood.
        wall: True for the pass that leaves the finished wall behind.
        wrench_tool: Process wrench at the tool centre point where the step begins, tool axes, shape (6,) [N, N m].
        wrench_end: The same where it ends, evenly from the one to the other; None: it stays as it is.
        std_tool: Standard deviations of its components, shape (6,) [N, N m].
        bounded: True where nobody measured the wrench, so that the correction for it is bounded.
        kind_of_feature: What the feature is whose force that is; empty where there is none.
        spindle_speed: Spindle speed [rad/s].
        name: Name of the target at the end; empty for a running number.
        via_name: Name of the circle point; empty for a running number.
        points: Joint angles that the robot passes before this step, one after the other, each of shape (6,) [rad].
    """

    kind: MotionKind
    curve: Curve
    R_door_tool: FloatArray
    speed: float
    zone: str = "z0"
    feature: str = ""
    cutting: bool = False
    wall: bool = False
    wrench_tool: FloatArray = field(default_factory=lambda: np.zeros(6))
    wrench_end: FloatArray | None = None
    std_tool: FloatArray = field(default_factory=lambda: np.zeros(6))
    bounded: bool = False
    kind_of_feature: str = ""
    spindle_speed: float = 0.0
    name: str = ""
    via_name: str = ""
    points: tuple[FloatArray, ...] = ()

    def part(self, first: float, last: float) -> Step:
        """The stretch between two fractions of the length; inner ends lose their names."""
        name = self.name if last == 1.0 else ""
        zone = self.zone if last == 1.0 else "z0"
        begin, end = self.wrench_at(first), None if self.wrench_end is None else self.wrench_at(last)
        curve = self.curve.part(first, last)
        return self.changed(curve=curve, name=name, via_name="", zone=zone, wrench_tool=begin, wrench_end=end)

    def wrench_at(self, fraction: float) -> FloatArray:
        """Process wrench at a fraction of the length, tool axes, shape (6,) [N, N m]."""
        if self.wrench_end is None:
            return self.wrench_tool
        return self.wrench_tool + fraction * (self.wrench_end - self.wrench_tool)

    @property
    def last_wrench(self) -> FloatArray:
        """Process wrench where the step ends, tool axes, shape (6,) [N, N m]."""
        return self.wrench_tool if self.wrench_end is None else self.wrench_end

    def changed(self, **values: Any) -> Step:
        """As `dataclasses.replace`, which would take a fifth of the time that a whole door does."""
        step = object.__new__(Step)
        step.__dict__.update(self.__dict__, **values)
        return step


@dataclass(frozen=True, eq=False)
class Plan:
    """Steps in the order of execution.

    Attributes:
        steps: Each starts where the one before ends. The first one's start is where its end is: its way from
            home leads through joint space.
        target_order: Names of the targets in the order of the target file when nothing may be
            added to them (the thesis' program); empty for the order of the first visit.
        escapes: For each feature in the order of milling the joint angles of its way home, each of shape (6,) [rad]:
            in front of it, then what is passed on the way.
    """

    steps: tuple[Step, ...]
    target_order: tuple[str, ...] = ()
    escapes: tuple[tuple[FloatArray, ...], ...] = ()

    @property
    def fixed(self) -> bool:
        """True when targets and motions may not be added."""
        return bool(self.target_order)
