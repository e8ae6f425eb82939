"""The localizer's node where camera.yaml has a picture of the empty clamp: refused, left out by parameter, or stale."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context
from std_msgs.msg import Header

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp
from doormill_ros.localization.errors import NoDoor, StaleEmptyClamp
from doormill_ros.messages.picture import picture_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Surface
from doormill_ros.units import MM
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


@pytest.mark.parametrize("way", [0.0, 0.5 * MM])
def test_a_stale_picture_is_told_beside_the_door(
    way: float, recorded: dict[str, bytes], context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    camera = load_camera()
    plain = Localizer(recorded, context)
    recipe = plain.good[topics.DOOR_RECIPE.name]
    mottled = Surface(0.18, mottle=0.1, mottle_size=2 * MM)
    scene = PictureScene(width=recipe.width, thickness=recipe.thickness, background=mottled)
    origin = scene.camera.origin + np.array([0.0, way, 0.0])
    before = replace(scene, door=False, camera=replace(scene.camera, origin=origin))
    clamp = EmptyClamp(recipe.width, render_picture(before, 3), camera.k, camera.distortion, "2026-03-01")
    known = replace(camera, empty=(clamp,))
    monkeypatch.setattr("doormill_ros.nodes.door_localizer.load_camera", lambda: known)
    one = Localizer(recorded, context)
    try:
        one.send(topics.CAMERA_INFO)
        message = picture_message(render_picture(scene, 3), Header(frame_id="camera"))
        one.send(topics.IMAGE, header=message.header, data=message.data)
        assert one.answers[-1].accepted, one.answers[-1].reason
        level, said, values = one.node._health[:3]
        if way:
            assert (level, values["error_code"]) == (WARN, StaleEmptyClamp.code)
            assert said.startswith("door found, but the picture of the empty clamp for doors of ")
            assert " mm, taken 2026-03-01, no longer fits: the background lies " in said
        else:
            assert (level, said) == (OK, "door found")
            assert "error_code" not in values
    finally:
        for localizer in (plain, one):
            localizer.node.close()
            localizer.node.destroy_node()
