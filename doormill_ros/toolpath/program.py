"""What the path generator hands to the ABB side: targets, and the motions that visit them."""

from __future__ import annotations

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
    """

    name: str
    T_base_tool_nominal: FloatArray
    T_base_tool_corrected: FloatArray
    q: FloatArray
    conf: ConfData
    wrench: FloatArray
    deflection: FloatArray


class MotionKind(str, Enum):
    """RAPID motion instruction."""

    JOINT = "MoveJ"
    LINEAR = "MoveL"
    CIRCULAR = "MoveC"


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion instruction.

    Attributes:
        kind: MoveJ, MoveL or MoveC.
        target: Index into the program's targets where the motion ends.
        via: Index of the circle point of a MoveC, None otherwise.
        speed: Tool centre point speed [m/s].
        zone: RAPID zone name: "fine", "z0", "z1", "z5", ... .
        feature: Identifier of the recipe feature, empty between features.
        cutting: True while the tool is in the wood.
        wrench: Process wrench along the motion on the tool at the tool centre point, base axes,
            shape (6,) [N, N m]; zero when not cutting.
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


@dataclass(frozen=True)
class MillingProgram:
    """Everything that is milled into one door in one clamping.

    Attributes:
        door_id: Door the program was made for.
        recipe_version: Version of the recipe it was made from.
        targets: Targets in the order of the RAPID target file.
        motions: Motions in the order of execution.
    """

    door_id: str
    recipe_version: int
    targets: tuple[Target, ...]
    motions: tuple[Motion, ...]

    @property
    def largest_correction(self) -> float:
        """Largest translation between nominal and corrected tool pose [m]."""
        if not self.targets:
            return 0.0
        steps = [t.T_base_tool_corrected[:3, 3] - t.T_base_tool_nominal[:3, 3] for t in self.targets]
        return float(np.linalg.norm(steps, axis=1).max())
