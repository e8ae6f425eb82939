"""Intrinsics in the form of ROS' camera_calibration, there and back; old calibrations put back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.localization.calibration.errors import BadCalibrationFile, NothingKept
from doormill_ros.localization.calibration.kept import keep, kept, restore
from doormill_ros.localization.calibration.ros_file import read_ros_file, write_ros_file
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.resources import resource

# As cameracalibrator writes it: five decimals, indented rows.
WRITTEN = """image_width: 1920
image_height: 1080
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [1678.35000,    0.     ,  946.41000,
            0.     , 1727.22000,  510.71000,
            0.     ,    0.     ,    1.     ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.080000, 0.050000, 0.000300, -0.000200, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1., 0., 0.,
         0., 1., 0.,
         0., 0., 1.]
projection_matrix:
  rows: 3
  cols: 4
  data: [1644.60000,    0.     ,  945.10000,    0.     ,
            0.     , 1700.20000,  510.70000,    0.     ,
            0.     ,    0.     ,    1.     ,    0.     ]
"""


def test_a_file_of_camera_calibration_is_read(tmp_path: Path) -> None:
    path = tmp_path / "ost.yaml"
    path.write_text(WRITTEN, encoding="utf-8")
    found = read_ros_file(path)
    assert (found.name, found.size) == ("narrow_stereo", (1920, 1080))
    np.testing.assert_array_equal(found.k, load_camera().k)
    np.testing.assert_array_equal(found.distortion, load_camera().distortion)


def test_there_and_back_nothing_is_lost(tmp_path: Path) -> None:
    path, camera = tmp_path / "camera.yaml", load_camera()
    write_ros_file(camera, "door", path)
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert list(document) == list(yaml.safe_load(WRITTEN))
    for name in ("camera_matrix", "distortion_coefficients", "rectification_matrix", "projection_matrix"):
        part = document[name]
        assert len(part["data"]) == part["rows"] * part["cols"]
    found = read_ros_file(path)
    np.testing.assert_array_equal(found.k, camera.k)
    np.testing.assert_array_equal(found.distortion, camera.distortion)
    assert (found.name, found.size) == ("door", camera.size)


def test_the_projection_shows_only_what_the_camera_saw(tmp_path: Path) -> None:
    path, camera = tmp_path / "camera.yaml", load_camera()
    write_ros_file(camera, "door", path)
    data = yaml.safe_load(path.read_text(encoding="utf-8"))["projection_matrix"]["data"]
    p = np.array(data).reshape(3, 4)
    width, height = camera.size
    rim = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]], dtype=float)
    rays = np.column_stack([rim, np.ones(4)]) @ np.linalg.inv(p[:, :3]).T
    seen = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), camera.k, camera.distortion)[0][:, 0]
    assert np.all(seen > -2)
    assert np.all(seen < np.array([width, height]) + 1)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("plumb_bob", "equidistant", "'equidistant' with 5 coefficients"),
        ("0.000300, -0.000200, 0.000000]", "0.0003]", "'plumb_bob' with 3 coefficients"),
        ("image_width: 1920\n", "", "image_width"),
        ("1678.35000", "0.0", "focal lengths of 192 to 96000 px"),
        ("946.41000", "94641", "centre inside the picture of 1920 x 1080 px"),
        ("image_width: 1920", "image_width: 640", "centre inside the picture of 640 x 1080 px"),
        ("image_width: 1920", "image_width: 192000", "192000 x 1080 px"),
        ("[-0.080000", "[-80", "distortion coefficients up to 80"),
        (
            "[-0.080000, 0.050000",
            "[-1.5, 0.0",
            "has no ray for 58% of the picture by its distortion, allowed are 25%",
        ),
        ("cols: 3\n  data: [1678", "cols: 4\n  data: [1678", "camera matrix of 3 x 4"),
        ("rows: 3\n  cols: 3\n  data: [1678", "rows: 9\n  cols: 1\n  data: [1678", "camera matrix of 9 x 1"),
        ("cols: 5", "cols: 4", "1 x 4 distortion coefficients and 5 numbers"),
        ("image_height: 1080", "image_height: tall", "tall"),
    ],
)
def test_a_file_of_no_use_is_refused(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert old in WRITTEN
    path = tmp_path / "ost.yaml"
    path.write_text(WRITTEN.replace(old, new), encoding="utf-8")
    with pytest.raises(BadCalibrationFile, match=says):
        read_ros_file(path)


def test_what_is_written_over_is_kept_and_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    first = resource("config/camera.yaml").read_text(encoding="utf-8")
    contents = [first, first.replace("z: -0.126", "z: -0.127"), first.replace("z: -0.126", "z: -0.128")]
    assert keep(path) is None
    for content in contents:
        keep(path)
        path.write_text(content, encoding="utf-8")
    assert [p.name for p in kept(path)] == ["001.yaml", "002.yaml"]
    assert restore(path).name == "002.yaml"
    assert path.read_text(encoding="utf-8") == contents[1]
    assert restore(path).name == "003.yaml"  # and back again: nothing is lost
    assert path.read_text(encoding="utf-8") == contents[2]
    assert restore(path, 1).name == "001.yaml"
    assert path.read_text(encoding="utf-8") == contents[0]
    with pytest.raises(NothingKept, match="number 9"):
        restore(path, 9)
    with pytest.raises(NothingKept, match="none are kept"):
        restore(tmp_path / "other.yaml")


def test_a_kept_file_that_was_damaged_is_not_put_back(tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text("size: [1, 1]\n", encoding="utf-8")
    keep(path)
    good = resource("config/camera.yaml").read_bytes()
    path.write_bytes(good)
    with pytest.raises(BadCameraFile):
        restore(path)
    assert path.read_bytes() == good
