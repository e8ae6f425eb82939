"""What a calibration writes is what the localiser can read, and what it states is used."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.localization.calibration.camera_file import (
    read_document,
    with_intrinsics,
    with_ros_intrinsics,
    write_document,
)
from doormill_ros.localization.calibration.intrinsics import Intrinsics, calibrate_intrinsics
from doormill_ros.localization.calibration.ros_file import RosIntrinsics
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.localization.settings import load_settings
from doormill_ros.resources import resource
from support.pictures.chessboard_corners import BOARD, SIZE, noisy_corners

NAMES = [f"{i}.png" for i in range(10)]


@pytest.fixture(scope="module")
def found() -> Intrinsics:
    return calibrate_intrinsics(noisy_corners(10, 3, 0.05), BOARD, SIZE)


@pytest.fixture
def document() -> dict[str, Any]:
    return read_document(resource("config/camera.yaml"))


def test_the_deviation_that_was_found_is_the_one_that_the_localizer_uses(
    found: Intrinsics, document: dict[str, Any], tmp_path: Path
) -> None:
    write_document(with_intrinsics(document, found, NAMES), tmp_path / "camera.yaml")
    share = max(found.k_deviation[0] / found.k[0, 0], found.k_deviation[1] / found.k[1, 1])
    assert load_settings(tmp_path / "camera.yaml").lens_deviation == pytest.approx(share)
    assert load_settings(tmp_path / "camera.yaml").lens_deviation != load_settings().lens_deviation


def test_a_lens_of_a_ros_file_is_not_said_to_be_as_sure_as_the_one_before(
    found: Intrinsics, document: dict[str, Any], tmp_path: Path
) -> None:
    sure = with_intrinsics(document, replace(found, k_deviation=np.full(4, 1e-3)), NAMES)
    camera = load_camera()
    ros = RosIntrinsics("other", camera.size, camera.k, camera.distortion)
    write_document(with_ros_intrinsics(sure, ros), tmp_path / "camera.yaml")
    assert load_settings(tmp_path / "camera.yaml").lens_deviation == load_settings().lens_deviation


@pytest.mark.parametrize("kept", [False, True])
def test_what_nothing_would_read_is_not_written(
    found: Intrinsics, document: dict[str, Any], tmp_path: Path, kept: bool
) -> None:
    path = tmp_path / "camera.yaml"
    if kept:
        path.write_text("as it was", encoding="utf-8")
    strange = replace(found, distortion=np.array([0.1, 0.2, 0.0, 0.0, 12.0]))
    with pytest.raises(BadCameraFile, match=r"which is not written,.* distortion coefficients up to 12"):
        write_document(with_intrinsics(document, strange, NAMES), path)
    height, width = SIZE[1] + 2, SIZE[0] + 2
    cv2.imwrite(str(tmp_path / "empty.png"), np.zeros((height, width), np.uint8))
    clamp = {"empty_clamp": [{"width": 0.8, "picture": str(tmp_path / "empty.png")}]}
    with pytest.raises(BadCameraFile, match=rf"which is not written,.* has {width} x {height} px"):
        write_document(with_intrinsics(document | clamp, found, NAMES), path)
    assert list(tmp_path.glob("camera*")) == ([path] if kept else [])
    if kept:
        assert yaml.safe_load(path.read_text(encoding="utf-8")) == "as it was"
