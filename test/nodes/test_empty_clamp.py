"""The localizer's node where camera.yaml has a picture of the empty clamp: refused, drawn, or left out by parameter."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.empty_clamp import EmptyClamp
from doormill_ros.localization.errors import NoDoor
from doormill_ros.messages.picture import picture_of
from doormill_ros.nodes import topics
from doormill_ros.nodes.reporting_node import OK
from support.localizer_node import Localizer


@pytest.fixture
def localizer(recorded: dict[str, bytes], context: Context, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Starts the node in a cell whose empty clamp looks as the recorded picture does, for doors of another width."""
    started: list[Localizer] = []

    def start(wider: float = 0.0, **parameters: Any) -> Localizer:
        plain = Localizer(recorded, context)
        picture = picture_of(plain.good[topics.IMAGE.name])
        width = plain.good[topics.DOOR_RECIPE.name].width + wider
        started.append(plain)
        camera = load_camera()
        known = replace(camera, empty=(EmptyClamp(width, np.array(picture), camera.k, camera.distortion),))
        monkeypatch.setattr("doormill_ros.nodes.door_localizer.load_camera", lambda: known)
        one = Localizer(recorded, context, **parameters)
        one.send(topics.CAMERA_INFO)
        started.append(one)
        return one

    yield start
    for one in started:
        one.node.close()
        one.node.destroy_node()


def test_the_empty_clamp_is_refused(localizer: Any) -> None:
    answer = localizer().answer()
    assert not answer.accepted
    assert answer.error_code == NoDoor.code
    assert answer.reason.startswith("no door stands there")


def test_the_parameter_leaves_it_out(localizer: Any) -> None:
    assert localizer(empty_clamp=False).answer().accepted


def test_a_width_without_a_picture_is_told(localizer: Any) -> None:
    one = localizer(wider=0.1)
    assert one.answer().accepted
    level, _, values = one.node._health[:3]
    assert level == OK
    assert values["empty_clamp"].startswith("no picture for this width, only for ")
