"""The camera of a picture by the camera info that came with it: the one that was mounted, or a sentence."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace as Message
from typing import Any

import numpy as np
import pytest

from doormill_ros.localization.calibration.ros_file import read_ros_file, write_ros_file
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.errors import BadCameraInfo
from doormill_ros.messages.camera_info import camera_of

WHOLE = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0}


def info_of(camera: CameraModel, **changes: Any) -> Message:
    """What a driver sends of the camera's whole sensor."""
    fields = {
        "k": camera.k.ravel().tolist(),
        "d": camera.distortion.tolist(),
        "width": camera.size[0],
        "height": camera.size[1],
        "distortion_model": "plumb_bob",
        "binning_x": 0,
        "binning_y": 0,
        "roi": Message(**WHOLE),
    }
    return Message(**{**fields, **changes})


def lens(distortion: Any = None, **changes: float) -> dict[str, Any]:
    """The shipped camera's lens with another focal length or centre."""
    k = load_camera().k.copy()
    for name, value in changes.items():
        k[{"fx": (0, 0), "fy": (1, 1), "cx": (0, 2), "cy": (1, 2), "skew": (0, 1)}[name]] = value
    return {"k": k.ravel().tolist()} | ({} if distortion is None else {"d": distortion})


def test_a_camera_info_of_the_cells_own_lens_is_the_mounted_camera() -> None:
    mounted = load_camera()
    camera = camera_of(info_of(mounted), mounted)
    assert np.array_equal(camera.k, mounted.k)
    assert np.array_equal(camera.distortion, mounted.distortion)
    assert camera.size == mounted.size
    assert np.array_equal(camera.T_base_camera(0.9), mounted.T_base_camera(0.9))


@pytest.mark.parametrize(
    "changes",
    [
        lens(fx=1678.35 * 1.01, fy=1727.22 * 1.01),
        lens(fx=1678.35 * 1.05, fy=1727.22 * 1.05),
        lens(fx=1678.35 * 1.0003, fy=1727.22 * 1.0003),
        lens(fx=1700.0, fy=1700.0, cx=959.5, cy=539.5),
        lens(cx=966.41),
        lens(cy=511.01),
        lens(skew=1.0),
        lens([0.0] * 5),
        lens([-0.08, 0.05, 0.0003, -0.0002, 0.01]),
        lens([9.0] * 5),
        {"d": [], "distortion_model": ""},
    ],
)
def test_another_lens_than_the_mounting_was_calibrated_with_is_refused(changes: dict[str, Any]) -> None:
    mounted = load_camera()
    info = info_of(mounted, **changes)
    with pytest.raises(BadCameraInfo) as refused:
        camera_of(info, mounted)
    said = refused.value.message
    for part in (
        f"focal lengths {info.k[0]:.2f} and {info.k[4]:.2f} px, centre ({info.k[2]:.2f}, {info.k[5]:.2f}) px",
        "focal lengths 1678.35 and 1727.22 px, centre (946.41, 510.71) px and distortion -0.08, 0.05, 0.0003, ",
        "allowed are 0.1 px",
        "calibrate extrinsics",
    ):
        assert part in said


@pytest.mark.parametrize("decimals", [5, 6])
def test_what_was_rounded_on_its_way_is_the_same_lens(decimals: int) -> None:
    rng = np.random.default_rng(decimals)
    for _ in range(200):
        k = load_camera().k * (1.0 + 0.02 * rng.uniform(-1, 1, (3, 3)) * [[1, 0, 1], [0, 1, 1], [0, 0, 0]])
        brown = rng.uniform(-1, 1, 5) * [0.2, 0.2, 1e-3, 1e-3, 0.1]
        mounted = load_camera().with_intrinsics(k, brown, (1920, 1080))
        rounded = info_of(mounted, k=np.round(k.ravel(), decimals), d=np.round(brown, decimals))
        assert np.array_equal(camera_of(rounded, mounted).distortion, rounded.d)


def test_what_went_through_the_file_of_ros_is_the_same_lens(tmp_path: Path) -> None:
    mounted = load_camera()
    write_ros_file(mounted, "door", tmp_path / "ros.yaml")
    found = read_ros_file(tmp_path / "ros.yaml")
    sent = info_of(mounted, k=found.k.ravel().tolist(), d=found.distortion.tolist())
    assert np.array_equal(camera_of(sent, mounted).k, found.k)


WINDOW = {"roi": Message(x_offset=140, y_offset=60, width=1600, height=960), "binning_x": 2, "binning_y": 2}


def test_a_part_of_the_sensor_is_held_against_the_lens_of_the_whole() -> None:
    mounted = load_camera()
    assert camera_of(info_of(mounted, **WINDOW), mounted).size == (800, 480)
    with pytest.raises(BadCameraInfo, match="of a lens with 1920 x 1080 px"):
        camera_of(info_of(mounted, **WINDOW, **lens(cx=947.0)), mounted)


def test_a_camera_calibrated_by_parts_of_its_sensor_is_held_against_those() -> None:
    mounted = camera_of(info_of(load_camera(), **WINDOW), load_camera())
    camera = camera_of(info_of(load_camera(), **WINDOW), mounted)
    assert np.array_equal(camera.k, mounted.k)
    with pytest.raises(BadCameraInfo, match="of a lens with 800 x 480 px"):
        camera_of(info_of(load_camera(), **WINDOW, **lens(cx=947.0)), mounted)


def test_another_size_than_the_calibrated_one_is_another_camera() -> None:
    mounted = load_camera()
    half = info_of(mounted, width=960, height=540, **lens(fx=839.175, fy=863.61, cx=472.955, cy=255.105))
    with pytest.raises(BadCameraInfo, match="of a lens with 960 x 540 px"):
        camera_of(half, mounted)


GOOD_INFO = {
    "k": [900.0, 0.0, 310.0, 0.0, 910.0, 250.0, 0.0, 0.0, 1.0],
    "d": [0.1, -0.2, 0.0, 0.0, 0.01],
    "width": 640,
    "height": 480,
    "distortion_model": "plumb_bob",
}
MOUNTED = load_camera().with_intrinsics(
    np.reshape(GOOD_INFO["k"], (3, 3)), np.array(GOOD_INFO["d"]), (640, 480)
)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"k": [0.0] * 9}, "no calibration"),
        ({"k": [math.nan] * 9}, "K = "),
        ({"k": [math.inf, *GOOD_INFO["k"][1:]]}, "K = "),
        ({"k": [1e-3, *GOOD_INFO["k"][1:]]}, "focal lengths"),
        ({"k": [900.0, 0.0, 3000.0, *GOOD_INFO["k"][3:]]}, "centre inside"),
        ({"k": [*GOOD_INFO["k"][:6], 1.0, 0.0, 1.0]}, "K = "),
        ({"width": 0, "height": 0}, "0 x 0 px"),
        ({"width": 4_294_967_295}, "4294967295 x 480"),
        ({"distortion_model": "equidistant", "d": [0.1, 0.0, 0.0, 0.0]}, "equidistant"),
        ({"distortion_model": "equidistant", "d": [0.0] * 4}, "equidistant"),
        ({"distortion_model": ""}, "distortion model ''"),
        (
            {"distortion_model": "rational_polynomial", "d": [0.1, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0]},
            "8 coeff",
        ),
        ({"d": [math.nan, 0.0, 0.0, 0.0, 0.0]}, "nan"),
        ({"d": [1e9, 0.0, 0.0, 0.0, 0.0]}, "1e[+]09"),
    ],
)
def test_a_camera_info_of_no_use_is_refused(changes: dict[str, object], says: str) -> None:
    camera_of(Message(**GOOD_INFO), MOUNTED)
    with pytest.raises(BadCameraInfo, match=says):
        camera_of(Message(**{**GOOD_INFO, **changes}), MOUNTED)


def test_lens_models_that_say_the_same_give_the_same_camera() -> None:
    eight = {"distortion_model": "rational_polynomial", "d": [*GOOD_INFO["d"], 0.0, 0.0, 0.0]}
    first, second = (camera_of(Message(**{**GOOD_INFO, **v}), MOUNTED) for v in ({}, eight))
    assert np.array_equal(first.distortion, second.distortion)
    lensless = MOUNTED.with_intrinsics(MOUNTED.k, np.zeros(5), MOUNTED.size)
    plain = camera_of(Message(**{**GOOD_INFO, "distortion_model": "", "d": []}), lensless)
    assert not plain.distortion.any()
