"""A camera that sends a part of its sensor, or several pixels as one: the same door, or a sentence."""

from __future__ import annotations

import array
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context
from sensor_msgs.msg import CameraInfo, RegionOfInterest

from doormill_ros.localization.errors import BadCameraInfo, CameraInfoSize, NoEdge
from doormill_ros.nodes.base import topics
from support.localizer_node import Localizer

NO_REGION = (0, 0, 0, 0)


@pytest.fixture
def localizer(recorded: dict[str, bytes], context: Context) -> Iterator[Localizer]:
    localizer = Localizer(recorded, context)
    localizer.send(topics.CAMERA_INFO)
    yield localizer
    localizer.node.close()
    localizer.node.destroy_node()


def sent(localizer: Localizer, region: tuple[int, int, int, int], bins: tuple[int, int]) -> np.ndarray:
    """What the same camera sends: a window x, y, width, height, means of `bins` pixels, what is left over cut off."""
    full = localizer.good[topics.IMAGE.name]
    picture = np.frombuffer(full.data, np.uint8).reshape(full.height, full.width)
    x, y, width, height = region if any(region) else (0, 0, full.width, full.height)
    cut = picture[y : y + height, x : x + width].astype(float)
    across, down = bins
    columns = [cut[:, i::across][:, : width // across] for i in range(across)]
    rows = [np.mean(columns, axis=0)[i::down][: height // down] for i in range(down)]
    return np.rint(np.mean(rows, axis=0)).astype(np.uint8)


def look_at(localizer: Localizer, picture: np.ndarray, **info: Any) -> Any:
    localizer.send(topics.CAMERA_INFO, **info)
    before = len(localizer.answers)
    localizer.send(
        topics.IMAGE,
        height=picture.shape[0],
        width=picture.shape[1],
        step=picture.shape[1],
        data=array.array("B", picture.tobytes()),
    )
    assert len(localizer.answers) == before + 1
    return localizer.answers[-1]


def region_of(numbers: tuple[int, int, int, int]) -> RegionOfInterest:
    x, y, width, height = numbers
    return RegionOfInterest(x_offset=x, y_offset=y, width=width, height=height, do_rectify=any(numbers))


@pytest.mark.parametrize(
    ("region", "bins", "place", "turn"),
    [
        (NO_REGION, (0, 0), 1e-9, 1e-9),
        (NO_REGION, (1, 1), 1e-9, 1e-9),
        ((140, 60, 1600, 960), (0, 0), 2e-6, 3e-5),
        ((141, 63, 1601, 961), (1, 1), 2e-6, 3e-5),
        (NO_REGION, (2, 2), 5e-6, 1e-4),
        (NO_REGION, (2, 1), 5e-6, 1e-4),
        ((141, 11, 1601, 1069), (2, 2), 5e-6, 1e-4),
    ],
)
def test_a_part_of_the_sensor_shows_the_door_at_the_same_place(
    localizer: Localizer,
    region: tuple[int, int, int, int],
    bins: tuple[int, int],
    place: float,
    turn: float,
) -> None:
    whole = localizer.answer()
    assert whole.accepted, whole.reason
    fields = {"roi": region_of(region), "binning_x": bins[0], "binning_y": bins[1]}
    picture = sent(localizer, region, tuple(max(1, n) for n in bins))
    part = look_at(localizer, picture, **fields)
    assert part.accepted, part.reason
    assert part.offset_y == pytest.approx(whole.offset_y, abs=place)
    assert part.offset_z == pytest.approx(whole.offset_z, abs=place)
    assert part.offset_rotation == pytest.approx(whole.offset_rotation, abs=turn)


def test_an_edge_that_binning_leaves_too_short_is_refused(localizer: Localizer) -> None:
    answer = look_at(localizer, sent(localizer, NO_REGION, (3, 3)), binning_x=3, binning_y=3)
    assert answer.error_code == NoEdge.code
    assert "60 are needed" in answer.reason


def test_a_picture_of_the_whole_sensor_is_no_part_of_it(localizer: Localizer) -> None:
    picture = sent(localizer, NO_REGION, (1, 1))
    answer = look_at(localizer, picture, roi=region_of((100, 100, 1600, 900)), binning_x=2, binning_y=2)
    assert answer.error_code == CameraInfoSize.code
    assert "800 x 450 px" in answer.reason
    assert "1920 x 1080 px" in answer.reason


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"roi": region_of((400, 0, 1600, 900))}, "region of interest of 1600 x 900 px at (400, 0)"),
        ({"roi": region_of((400, 0, 0, 0))}, "region of interest of 0 x 0 px"),
        ({"roi": region_of((4_294_967_295, 0, 4_294_967_295, 10))}, "region of interest"),
        ({"binning_x": 200, "binning_y": 100}, "binning of 200 x 100 px"),
        ({"roi": region_of((0, 0, 20, 20)), "binning_x": 4, "binning_y": 4}, "leaves 5 x 5 px"),
    ],
)
def test_a_part_that_no_sensor_has_is_refused(
    localizer: Localizer, fields: dict[str, Any], says: str
) -> None:
    answer = look_at(localizer, sent(localizer, NO_REGION, (1, 1)), **fields)
    assert not answer.accepted
    assert answer.error_code == BadCameraInfo.code
    assert says in answer.reason
    assert look_at(localizer, sent(localizer, NO_REGION, (1, 1)), roi=RegionOfInterest()).accepted


def test_the_defaults_of_the_message_are_the_whole_sensor() -> None:
    info = CameraInfo()
    assert (info.binning_x, info.binning_y, info.roi.width, info.roi.height) == (0, 0, 0, 0)
