"""What the path generator hands to the ABB side: targets, and the motions that visit them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.configuration import ConfData


@dataclass(frozen=True, eq=False)
class Target:
    """One robot target.

    Attributes:
        name: Name within the program, the thesis' where it has one ("init", "10", ...).
        T_base_tool_nominal: Where the tool shall be, shape (4, 4).
        T_base_tool_corrected: What the robot is told so that it deflects onto the nominal pose.
        q: Joint angles at the corrected pose, shape (6,) [rad].
        conf: RAPID configuration of `q`.
        wrench: Process wrench on the tool at the tool centre point, base axes, shape (6,) [N, N m].
        deflection: Predicted twist of the tool at the corrected pose, base axes, shape (6,) [m, rad].
        expected_error: How far the tool is expected beside the nominal pose while it leaves a finished wall: what the
            correction leaves, and one standard deviation of what springs and forces leave to chance [m]. 0 elsewhere.
    """

    name: str
    T_base_tool_nominal: FloatArray
    T_base_tool_corrected: FloatArray
    q: FloatArray
    conf: ConfData
    wrench: FloatArray
    deflection: FloatArray
    expected_error: float = 0.0


class MotionKind(str, Enum):
    """RAPID motion instruction.

    A MoveJ ends in the configuration that its target says, which a calibrated arm may not have near a border of two.
    Programs have none: joint by joint they go to points of joint space. Bags of earlier programs tell of some.
    """

    JOINT = "MoveJ"
    LINEAR = "MoveL"
    CIRCULAR = "MoveC"
    ABSOLUTE = "MoveAbsJ"
    PUT = "PutTool"
    TAKE = "TakeTool"
    MEASURE = "MeasureTool"


#: What is done at the rack, from and to a posture in front of it.
RACK_KINDS = (MotionKind.PUT, MotionKind.TAKE, MotionKind.MEASURE)
#: Motions that end at points of joint space.
AT_POINTS = (MotionKind.ABSOLUTE, *RACK_KINDS)


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion instruction.

    Attributes:
        kind: MoveL, MoveC or MoveAbsJ, or what is done at the rack.
        target: Index into the program's targets where the motion ends; of a MoveAbsJ into its points. At the rack the
            point in front of it, where the robot stands before and after.
        via: Index of the circle point of a MoveC; at the rack the place of the tool, from 0; None otherwise.
        speed: Tool centre point speed [m/s].
        zone: RAPID zone name: "fine", "z0", "z1", "z5", ... .
        feature: Identifier of the recipe feature, empty between features.
        cutting: True while the tool is in the wood.
        wrench: Process wrench on the tool at the tool centre point where the motion begins, base axes,
            shape (6,) [N, N m]; zero when not cutting.
        wrench_end: The same where it ends, evenly from the one to the other; None: it stays as it is.
        spindle_speed: Spindle speed during the motion [rad/s].
    """

    kind: MotionKind
    target: int
    via: int | None
    speed: float
    zone: str
    feature: str
    cutting: bool
    wrench: FloatArray = field(default_factory=lambda: np.zeros(6))
    spindle_speed: float = 0.0
    wrench_end: FloatArray | None = None

    @property
    def last_wrench(self) -> FloatArray:
        """Process wrench where the motion ends, base axes, shape (6,) [N, N m]."""
        return self.wrench if self.wrench_end is None else self.wrench_end

    def wrench_at(self, share: FloatArray) -> FloatArray:
        """Process wrench at shares 0..1 of the way, base axes, shapes (n,) -> (n, 6) [N, N m]."""
        wrench: FloatArray = self.wrench + share[:, None] * (self.last_wrench - self.wrench)
        return wrench


@dataclass(frozen=True)
class MillingProgram:
    """Everything that is milled into one door in one clamping.

    Attributes:
        door_id: Door the program was made for.
        recipe_version: Version of the recipe it was made from.
        targets: Targets in the order of the RAPID target file.
        motions: Motions in the order of execution. The first one starts at home; after the last one the robot goes
            home joint by joint.
        points: Joint angles that MoveAbsJ passes between features, each of shape (6,) [rad].
        home: Where the program begins and ends, shape (6,) [rad]; None in a program of targets alone.
        escapes: For each of `features` its points of the way home from there. The first is the posture in front of
            the feature, to which the tool is drawn straight back; after the last one comes home.
        tool: T_flange_tool of the tool whose tip the targets are of, shape (4, 4); None where nobody has told it.
    """

    door_id: str
    recipe_version: int
    targets: tuple[Target, ...]
    motions: tuple[Motion, ...]
    points: tuple[FloatArray, ...] = ()
    home: FloatArray | None = None
    escapes: tuple[range, ...] = ()
    tool: FloatArray | None = None

    @functools.cached_property
    def features(self) -> tuple[str, ...]:
        """Identifiers of the features in the order of milling."""
        return tuple(dict.fromkeys(motion.feature for motion in self.motions if motion.feature))

    def q_after(self, motion: Motion) -> FloatArray:
        """Joint angles at the end of one of the program's motions, shape (6,) [rad]."""
        if motion.kind in AT_POINTS:
            return self.points[motion.target]
        return self.targets[motion.target].q

    @property
    def expected_error(self) -> float:
        """Largest expected error of any wall [m]."""
        return max((target.expected_error for target in self.targets), default=0.0)

    @property
    def largest_correction(self) -> float:
        """Largest translation between nominal and corrected tool pose [m]."""
        if not self.targets:
            return 0.0
        steps = [t.T_base_tool_corrected[:3, 3] - t.T_base_tool_nominal[:3, 3] for t in self.targets]
        return float(np.linalg.norm(steps, axis=1).max())
