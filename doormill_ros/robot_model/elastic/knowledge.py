"""What a model knows of its own figures: springs, gaps and the process force, each with its standard deviation.

Where milled doors have measured the force, what a recipe says of its spread holds no longer: across the tool the
wrench is known to a share of its size and an angle, for the kinds of features that were measured. Of the force along
the tool and of the moments walls tell next to nothing, so there the recipe's spread stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.compliance import ComplianceModel


@dataclass(frozen=True)
class MeasuredForce:
    """How well milled doors tell the process force.

    Attributes:
        kinds: Of features that were measured.
        factor_std: Standard deviation of the wrench, as a share of the assumed one.
        angle_std: Of its direction about the tool [rad].
    """

    kinds: tuple[str, ...]
    factor_std: float
    angle_std: float

    def __post_init__(self) -> None:
        """Refuse what is no spread; raises ValueError."""
        for name, found in (("factor_std", self.factor_std), ("angle_std", self.angle_std)):
            if not (np.isfinite(found) and found >= 0.0):
                raise ValueError(f"{name} of measured_force is {found}, allowed are 0 and more")

    def document(self) -> dict[str, Any]:
        """As model.yaml has it."""
        return {"kinds": list(self.kinds), "factor_std": self.factor_std, "angle_std": self.angle_std}


def measured_force_of(document: Mapping[str, Any]) -> MeasuredForce:
    """The section `measured_force` of model.yaml.

    Raises:
        KeyError, TypeError, ValueError: It is not of its form.
    """
    kinds = document["kinds"]
    if not isinstance(kinds, list) or not all(isinstance(kind, str) for kind in kinds):
        raise ValueError(f"kinds of measured_force is {kinds!r}, allowed is a list of kinds of features")
    return MeasuredForce(tuple(kinds), float(document["factor_std"]), float(document["angle_std"]))


@dataclass(frozen=True, eq=False)
class ModelKnowledge:
    """Figures of a model and how well they are known.

    Attributes:
        stiffness: Springs of the joints, shape (6,) [N m / rad].
        stiffness_std: Of those that the model's diagnosis measured, nan for others, shape (6,) [N m / rad].
        gap_std: Of the gaps of the joints, 0 where none was measured, shape (6,) [rad].
        force: Of the process force; None where nobody measured it on doors.
    """

    stiffness: FloatArray
    stiffness_std: FloatArray
    gap_std: FloatArray
    force: MeasuredForce | None


@runtime_checkable
class KnowingModel(ComplianceModel, Protocol):
    """A model that tells how well it is known, and which wrench it takes a process to have."""

    def knowledge(self) -> ModelKnowledge:
        """Its figures."""
        ...

    def felt(self, q: FloatArray, wrench: FloatArray) -> FloatArray:
        """The wrench that acts where one is assumed.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            wrench: Assumed, base axes, shape (n, 6) [N, N m].

        Returns:
            Base axes, shape (n, 6) [N, N m].
        """
        ...
