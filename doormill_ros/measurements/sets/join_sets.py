"""Puts several loading tests of one robot together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.sets.measurement_set import MeasurementSet

_COLUMNS = ("time", "dt", "temperature", "q", "direction", "wrench", "displacement")


def join_sets(sets: Sequence[MeasurementSet]) -> MeasurementSet:
    """One set of all trials; trial numbers that meet again are shifted.

    Raises:
        SetMixError: Robot, model, sensor mounting or a reflector of the same name differ.
    """
    first = sets[0]
    if len(sets) == 1:
        return first
    reflectors = dict(first.reflectors)
    for other in sets[1:]:
        check_same_model(first, other)
        for name in ("wrench_frame_rotation", "load_point", "noise"):
            _require_equal(first, other, name, getattr(first, name), getattr(other, name))
        for name, reflector in other.reflectors.items():
            known = reflectors.setdefault(name, reflector)
            if known.link != reflector.link or not np.array_equal(known.position, reflector.position):
                raise SetMixError(
                    f"{other.path / 'set.yaml'}: line 1, column 1: reflector {name} sits elsewhere than in "
                    f"{first.path}; give it another name"
                )
    trial, shift = [], 0
    for one in sets:
        trial.append(one.trial + shift)
        shift = int(trial[-1].max())
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(one, name) for one in sets]) for name in _COLUMNS
    }
    return replace(
        first,
        reflectors=reflectors,
        trial=np.concatenate(trial),
        reflector=np.concatenate([one.reflector for one in sets]),
        **columns,
    )


def check_same_model(first: MeasurementSet, other: MeasurementSet) -> None:
    """A set can be predicted by what another set taught if both are of one robot and question one model.

    Raises:
        SetMixError: They are not.
    """
    _require_equal(first, other, "robot", first.robot, other.robot)
    _require_equal(first, other, "model.joint_stiffness", first.joint_stiffness, other.joint_stiffness)


def _require_equal(
    first: MeasurementSet, other: MeasurementSet, name: str, mine: object, theirs: object
) -> None:
    if not np.array_equal(mine, theirs):  # type: ignore[arg-type]
        raise SetMixError(
            f"{other.path / 'set.yaml'}: line 1, column 1: {name} is {theirs}, but {mine} in {first.path}; "
            "sets used together need the same"
        )
