"""The wrench that a robot feels where a recipe assumes one, and how well it is known, by what its model measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.correction.loads import Loads
from doormill_ros.frames import cross
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.robot_model.elastic.knowledge import KnowingModel
from doormill_ros.robot_model.gravity.model import SaggingModel


def knowing(model: ComplianceModel) -> KnowingModel | None:
    """The part of a model that tells how well it is known."""
    inner = model.springs if isinstance(model, SaggingModel) else model
    return inner if isinstance(inner, KnowingModel) else None


def felt(
    model: ComplianceModel, loads: Loads, q: FloatArray, axis_of: Callable[[FloatArray], FloatArray]
) -> Loads:
    """Loads as they act, with the spread that is left of them.

    Where doors measured the force, a share of the wrench and a small turn about the tool take the place of what the
    recipe says of the two components across it. A force that nobody measured stays in all the doubt that it was in.

    Args:
        model: How the robot gives way; one that tells nothing of forces changes none.
        loads: n loads, as assumed; the rows 0 and 1 of their spread are the components across the tool.
        q: Joint angles, shape (n, 6) [rad].
        axis_of: Axis of the tool, base axes, shape (n, 3), at such joint angles; few models ask for it.
    """
    knower = knowing(model)
    if knower is None:
        return loads
    wrench, spread = knower.felt(q, loads.wrench), loads.spread.copy()
    force = knower.knowledge().force
    if force is not None:
        known = ~loads.bounded & np.isin(loads.kind, force.kinds)
        axis = axis_of(q)
        turn = np.concatenate([cross(axis, wrench[:, :3]), cross(axis, wrench[:, 3:])], axis=1)
        by_doors = np.stack([force.factor_std * loads.wrench, force.angle_std * turn], axis=1)
        spread[:, :2] = np.where(known[:, None, None], by_doors, spread[:, :2])
    return replace(loads, wrench=wrench, spread=spread)
