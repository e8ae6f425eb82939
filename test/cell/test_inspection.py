"""The worst feature of a door decides."""

from __future__ import annotations

import math

import pytest

from doormill_ros.cell.output.inspection import MeasuredDoor

NAN = math.nan


@pytest.mark.parametrize(
    ("features", "good"),
    [
        ([("a", 0.1), ("worst", 0.3), ("c", 0.2)], True),
        ([("a", 0.6), ("worst", NAN), ("c", 0.2)], False),
        ([("worst", NAN), ("a", math.inf)], False),
        ([("a", 0.2), ("worst", 0.7)], False),
    ],
)
def test_the_worst_feature_is_named_and_decides(features: list[tuple[str, float]], good: bool) -> None:
    found = MeasuredDoor.worst(features, 0.5)
    assert found.feature == "worst"
    assert found.out_of_tolerance is not good


def test_a_door_without_features_was_not_measured() -> None:
    found = MeasuredDoor.worst([], 0.5)
    assert not found.measured
    assert not found.out_of_tolerance
    assert found.sentence == "not measured"


def test_at_its_tolerance_a_door_is_good() -> None:
    assert not MeasuredDoor("a", 0.5, 0.5).out_of_tolerance
    assert MeasuredDoor("a", math.nextafter(0.5, 1.0), 0.5).out_of_tolerance
