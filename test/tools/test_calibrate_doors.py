"""calibrate extrinsics and check: what is written, what is refused, and with which status."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.calibration.scale_test import ScaleTest
from doormill_ros.localization.camera import load_camera
from doormill_ros.resources import resource
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from doormill_ros.tools.calibrate import main
from doormill_ros.tools.calibration import doors

MOVES = [[0, 0, 0], [0, 10, 0], [0, 0, 10]]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with pictures of a moved door, and their list."""
    folder = tmp_path_factory.mktemp("moves")
    rig = AxisVisionRig.load()
    rig.document["cameras"] = rig.document["cameras"][:1]
    for i, move in enumerate(MOVES):
        T_base_door = load_layout().T_base_door(0.8, 0.05)
        T_base_door[:3, 3] += np.array(move) * 1e-3
        cv2.imwrite(str(folder / f"{i}.png"), rig.take(T_base_door, 0.8, 2.0, 0.05, i, rig_seed=3)["1"])
    return folder


def listed(folder: Path, name: str = "moves.yaml", **other: object) -> str:
    entries = [{"picture": f"{i}.png", "move": move} for i, move in enumerate(MOVES)]
    document = {"width": 800, "height": 2000, "thickness": 50, "pictures": entries} | other
    (folder / name).write_text(yaml.safe_dump(document), encoding="utf-8")
    return str(folder / name)


def camera_file(folder: Path, change: dict[str, object], without: tuple[str, ...] = ()) -> str:
    document = yaml.safe_load(resource("config/camera.yaml").read_text(encoding="utf-8")) | change
    path = folder / "changed.yaml"
    path.write_text(yaml.safe_dump({k: v for k, v in document.items() if k not in without}), encoding="utf-8")
    return str(path)


def test_a_scale_that_is_wrong_ends_with_1_and_the_file_before_is_kept(
    pictures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "camera.yaml"
    out.write_bytes(resource("config/camera.yaml").read_bytes())
    before = out.read_bytes()
    wrong = ScaleTest(1, np.array([0.01, 0.0]), np.array([0.0095, 0.0]), 1e-5)
    monkeypatch.setattr(doors, "scale_tests", lambda *_: [wrong])
    assert main(["extrinsics", listed(pictures), "--out", str(out)]) == 1
    told = capsys.readouterr().out
    assert "WRONG: calibrate again" in told
    assert "calibrate restore" in told
    assert out.read_bytes() != before
    assert main(["restore", str(out)]) == 0
    assert out.read_bytes() == before


def test_a_move_with_a_part_along_x_is_seen_as_far_as_it_was(
    pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rig = AxisVisionRig.load()
    rig.document["cameras"] = rig.document["cameras"][:1]
    T_base_door = load_layout().T_base_door(0.8, 0.05)
    T_base_door[:3, 3] += np.array([-0.005, 0.010, 0.0])
    cv2.imwrite(str(pictures / "x.png"), rig.take(T_base_door, 0.8, 2.0, 0.05, 9, rig_seed=3)["1"])
    entries = [{"picture": f"{i}.png", "move": move} for i, move in enumerate(MOVES)]
    entries.append({"picture": "x.png", "move": [-5, 10, 0]})
    moves, out = listed(pictures, "x.yaml", pictures=entries), tmp_path / "out.yaml"
    assert main(["extrinsics", moves, "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "picture 4: moved by y, z = 10.000, 0.000 mm, seen " in told
    assert "WRONG" not in told


@pytest.mark.parametrize(
    ("change", "without", "says"),
    [
        ({}, ("localizer",), "localizer"),
        ({}, ("intrinsics",), "intrinsics"),
        ({"intrinsics": {"k": "none"}}, (), "intrinsics.k"),
        ({"localizer": 5}, (), "localizer"),
        ({"chessboard": 5}, (), "chessboard.covariance"),
        ({"chessboard": {"covariance": [["a"]]}}, (), "chessboard.covariance"),
        ({"chessboard": {"covariance": [[1.0] * 9] * 8 + [[0.0] * 9]}}, (), "chessboard.covariance"),
        ({"chessboard": {"covariance": (-np.eye(9)).tolist()}}, (), "chessboard.covariance"),
    ],
)
def test_a_camera_file_of_no_use_is_refused_and_nothing_is_written(
    change: dict[str, object],
    without: tuple[str, ...],
    says: str,
    pictures: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out.yaml"
    camera = camera_file(tmp_path, change, without)
    assert main(["extrinsics", listed(pictures), "--camera", camera, "--out", str(out)]) == 2
    told = capsys.readouterr().err
    assert told.startswith("calibration: ")
    assert says in told
    assert told.count("\n") == 1
    assert not out.exists()


def test_numbers_that_yaml_takes_for_text_are_numbers_here_too(pictures: Path, tmp_path: Path) -> None:
    """`lens_deviation: 3e-4` is what locate accepts."""
    camera = tmp_path / "camera.yaml"
    text = resource("config/camera.yaml").read_text(encoding="utf-8")
    assert "lens_deviation: 3.0e-4" in text
    camera.write_text(text.replace("lens_deviation: 3.0e-4", "lens_deviation: 3e-4"), encoding="utf-8")
    out = tmp_path / "out.yaml"
    assert main(["extrinsics", listed(pictures), "--camera", str(camera), "--out", str(out)]) == 0
    again = tmp_path / "again.yaml"
    assert main(["extrinsics", listed(pictures), "--out", str(again)]) == 0
    np.testing.assert_allclose(load_camera(out).position, load_camera(again).position)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"noise": 1e300}, "noise is 1e+300, allowed is a number of grey levels above 0, up to 255"),
        ({"noise": 0}, "noise is 0, allowed is a number of grey levels above 0, up to 255"),
        ({"min_contrast": 1e300}, "min_contrast is 1e+300, allowed is a number of grey levels from 0 to 255"),
        ({"width": 1e300}, "width is 1e+300, allowed is millimetres above 0, up to 10000"),
        ({"thickness": 1e300}, "thickness is 1e+300, allowed is millimetres above 0, up to 10000"),
        (
            {"thickness_deviation": 1e300},
            "thickness_deviation is 1e+300, allowed is millimetres from 0 to 10",
        ),
        (
            {"pictures": [{"picture": "0.png", "move": [0, 1e300, 0]}]},
            "pictures.0.move is [0.0, 1e+300, 0.0], allowed are millimetres up to 10000",
        ),
    ],
)
def test_numbers_that_no_list_of_moves_has_are_refused(
    change: dict[str, object], says: str, pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    moves = listed(pictures, "strange.yaml", **change)
    assert main(["extrinsics", moves, "--out", str(tmp_path / "out.yaml")]) == 2
    assert says in capsys.readouterr().err


def test_pictures_of_another_size_than_the_camera_s_are_told_as_that(
    pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for i in range(len(MOVES)):
        picture = cv2.imread(str(pictures / f"{i}.png"), cv2.IMREAD_GRAYSCALE)
        cv2.imwrite(str(tmp_path / f"{i}.png"), cv2.resize(picture, None, fx=0.5, fy=0.5))
    assert main(["extrinsics", listed(tmp_path), "--out", str(tmp_path / "out.yaml")]) == 2
    assert "the camera info is for 1920 x 1080 px, the picture has 960 x 540 px" in capsys.readouterr().err
