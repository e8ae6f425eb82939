"""What a contradiction is, and what its proof may use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import Recovery
from doormill_ros.units import m_to_um


@dataclass(frozen=True)
class Contradiction:
    """Two printed things that cannot both hold.

    Attributes:
        name: Short name.
        places: Where they are printed.
        finding: What cannot both hold, with the numbers, and what follows.
        numbers: The numbers by name, SI.
    """

    name: str
    places: str
    finding: str
    numbers: dict[str, float]

    def __str__(self) -> str:
        return f"- {self.name} ({self.places}): {self.finding}"


@dataclass(frozen=True, eq=False)
class Evidence:
    """The printed figures, the stiffness they give and the kinematics of the robot."""

    data: ThesisData
    recovery: Recovery
    kinematics: Kinematics

    def components(self, joint: int) -> float:
        """Length of the simulated components an appendix prints [m]."""
        return float(np.linalg.norm(self.data.test(joint).simulated_components))


def um(value: float) -> str:
    """A length for a sentence."""
    return f"{m_to_um(value):.1f} um"
