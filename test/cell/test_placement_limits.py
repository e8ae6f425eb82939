"""How far off a door may stand: at the limit, at what the measurement may add to it, and beyond both."""

from __future__ import annotations

import pytest

from doormill_ros.cell.places.layout import CAMERA_SLACK, SENSOR_SLACK, DoorOffset, Slack, load_layout

LIMITS = load_layout().limits


@pytest.mark.parametrize("slack", [CAMERA_SLACK, SENSOR_SLACK])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("axis", ["y", "z", "rotation"])
def test_a_door_may_stand_off_by_the_limit_and_the_slack(axis: str, sign: float, slack: Slack) -> None:
    most = getattr(LIMITS, axis) + (slack.rotation if axis == "rotation" else slack.position)
    for share, found in ((0.0, ()), (0.9999, ()), (1.0001, (axis,))):
        assert LIMITS.beyond(DoorOffset(**{axis: sign * share * most}), slack) == found


def test_every_axis_beyond_is_told() -> None:
    assert LIMITS.beyond(DoorOffset(1.0, 0.0, -1.0), SENSOR_SLACK) == ("y", "rotation")


def test_who_plans_accepts_every_door_that_the_camera_may() -> None:
    assert SENSOR_SLACK.position >= CAMERA_SLACK.position
    assert SENSOR_SLACK.rotation >= CAMERA_SLACK.rotation
