"""What the links of an arm weigh, as a robot's description states it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import StrictBool, model_validator

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.urdf import JOINTS
from doormill_ros.values import Array, Name, Section, contradiction


@dataclass(frozen=True, eq=False)
class LinkWeights(Section):
    """Masses of the moving links.

    Attributes:
        mass: Shape (6,) [kg].
        std: Standard deviation of each, with what its centre leaves to chance, shape (6,) [kg].
        centre: Centres of mass in the links' Denavit-Hartenberg frames, shape (6, 3) [m].
        balanced: Share of the links' torque about each joint that a balancing cylinder carries, no gear, shape (6,).
        balanced_std: Its standard deviation, shape (6,).
        source: Where the figures come from.
        measured: Whether somebody measured them on a robot of this type.
    """

    mass: Annotated[FloatArray, Array((JOINTS,))]
    std: Annotated[FloatArray, Array((JOINTS,))]
    centre: Annotated[FloatArray, Array((JOINTS, 3))]
    balanced: Annotated[FloatArray, Array((JOINTS,))]
    balanced_std: Annotated[FloatArray, Array((JOINTS,))]
    source: Name
    measured: StrictBool

    @model_validator(mode="after")
    def _possible(self) -> LinkWeights:
        for name in ("mass", "std", "balanced", "balanced_std"):
            if np.any(getattr(self, name) < 0.0):
                raise contradiction(f"links.{name} has negative numbers, allowed are numbers from 0 up")
        return self
