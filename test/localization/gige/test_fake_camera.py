"""The device against aravis' fake camera: pictures bit by bit, packets lost, restarted, unplugged, taken by another."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.localization.gige.aravis_device import AravisDevice
from doormill_ros.localization.gige.errors import CameraAbsent, CameraUnfit, PictureLost
from doormill_ros.localization.gige.library import load_aravis
from doormill_ros.localization.gige.line import CameraLine
from support.gige.fake_camera import ADDRESS, EXPOSURE, FakeCamera

SIZE = (1920, 1080)
#: An eighth of the pictures comes whole: 260 packets.
PACKET, LOST = 8000, 0.008
SCENE = np.random.default_rng(5).integers(0, 120, SIZE[::-1], dtype=np.uint8)


def reach(size: tuple[int, int] = SIZE) -> AravisDevice:
    return AravisDevice(load_aravis(), ADDRESS, size, PACKET)


@pytest.fixture
def camera(tmp_path: Path) -> Iterator[FakeCamera]:
    camera = FakeCamera(tmp_path / "scene.npy")
    camera.show(SCENE)
    with camera:
        yield camera


@pytest.fixture
def line(camera: FakeCamera) -> Iterator[CameraLine]:
    line = CameraLine(reach)
    yield line
    line.close()


def test_pictures_come_as_they_were_exposed(line: CameraLine) -> None:
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)
    np.testing.assert_array_equal(line.take(2 * EXPOSURE, 0.0), 2 * SCENE)
    np.testing.assert_allclose(line.take(EXPOSURE, 6.0), SCENE * 10**0.3, atol=0.51)
    assert (line.lost, line.reached) == (0, 1)


def test_a_picture_is_the_one_that_was_asked_for(camera: FakeCamera, line: CameraLine) -> None:
    """Nothing runs ahead in the camera or in the buffers."""
    for number in range(8):
        camera.show(SCENE + np.uint8(number))
        np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE + np.uint8(number))


def test_packets_get_lost_and_no_picture_has_a_hole(tmp_path: Path) -> None:
    camera = FakeCamera(tmp_path / "scene.npy", LOST)
    camera.show(SCENE)
    line, whole, reasons = CameraLine(reach), 0, []
    with camera:
        for _ in range(10):
            try:
                np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)
                whole += 1
            except PictureLost as error:
                reasons.append(error.message)
        line.close()
    assert whole >= 1
    assert line.lost > 10
    assert all("status missing-packets" in reason or "status timeout" in reason for reason in reasons)


def test_a_restarted_camera_is_set_up_again(camera: FakeCamera, line: CameraLine) -> None:
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)
    camera.unplug()
    camera.plug()
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)
    assert line.reached == 2


def test_an_unplugged_camera_is_said_and_reached_when_it_is_back(
    camera: FakeCamera, line: CameraLine
) -> None:
    line.take(EXPOSURE, 0.0)
    camera.unplug()
    with pytest.raises(CameraAbsent, match=f"camera {ADDRESS} does not answer .*; check its cable"):
        line.take(EXPOSURE, 0.0)
    with pytest.raises(CameraAbsent):
        line.watch()
    camera.plug()
    line.watch()
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)


def test_a_camera_that_obeys_another_program_is_said(line: CameraLine) -> None:
    line.take(EXPOSURE, 0.0)
    with pytest.raises(CameraAbsent, match="obeys somebody else"):
        reach()
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)


def test_a_camera_that_was_let_go_of_is_free(line: CameraLine) -> None:
    line.watch()
    line.close()
    other = reach()
    assert other.alive()
    other.close()


@pytest.mark.usefixtures("camera")
def test_a_sensor_smaller_than_the_calibration_is_refused() -> None:
    with pytest.raises(CameraUnfit, match="has 2048 x 2048 px, its calibration is for 4096 x 3000 px"):
        reach((4096, 3000))


@pytest.mark.parametrize(
    ("exposure", "gain", "said"), [(60.0, 0.0, "exposure is 60 s"), (EXPOSURE, 40.0, "gain is 40 dB")]
)
def test_what_the_camera_cannot_do_is_refused(
    line: CameraLine, exposure: float, gain: float, said: str
) -> None:
    with pytest.raises(CameraUnfit, match=f"{said}, camera {ADDRESS} allows"):
        line.take(exposure, gain)
    np.testing.assert_array_equal(line.take(EXPOSURE, 0.0), SCENE)
