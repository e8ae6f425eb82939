"""The command line: pictures in, a camera file that the localiser reads out."""

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.calibration.board_view import BoardPicture
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.pictures.picture_file import write_picture
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture.scene import Sensor
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from doormill_ros.tools.calibrate import main
from doormill_ros.tools.calibration import boards
from support.pictures.chessboard import render_chessboard
from support.pictures.chessboard_corners import CAMERA, SIZE, TRUE_K, held_upright, views


def test_chessboards_become_a_camera_file(tmp_path, capsys):
    names = []
    for i, view in enumerate(views(7, seed=8)):
        names.append(str(tmp_path / f"board{i}.png"))
        cv2.imwrite(names[-1], render_chessboard(CAMERA, view, Sensor(blur=0.8), i))
    blank = tmp_path / "blank.png"
    cv2.imwrite(str(blank), np.full(SIZE[::-1], 90, np.uint8))
    out = tmp_path / "camera.yaml"
    drawn = tmp_path / "coverage.png"
    arguments = [*names, str(blank), "--square", "20", "--out", str(out), "--coverage", str(drawn)]
    assert main(["intrinsics", *arguments]) == 0
    assert cv2.imread(str(drawn)).shape[:2] == SIZE[::-1]
    text = capsys.readouterr().out
    assert "7 of 8 pictures used" in text
    assert "blank.png: refused, no board found" in text
    assert "missing: 5 more pictures" in text
    camera = load_camera(out)
    assert camera.size == SIZE
    np.testing.assert_allclose(camera.k, TRUE_K, atol=3.0)
    document = yaml.safe_load(out.read_text(encoding="utf-8"))
    assert document["intrinsics"]["measured"] is True
    assert len(document["intrinsics"]["deviation"]) == 4
    assert document["chessboard"]["rejected"] == ["blank.png"]
    assert camera.position == pytest.approx(load_camera().position)  # the mounting is kept


def test_a_moved_door_becomes_a_mounting(tmp_path, capsys):
    rig, pictures = AxisVisionRig.load(), []
    rig.document["cameras"] = rig.document["cameras"][:1]
    for i, move in enumerate([(0, 0, 0), (0, 10, 0), (0, 0, 10)]):
        T_base_door = load_layout().T_base_door(0.8, 0.05)
        T_base_door[:3, 3] += np.array(move) * 1e-3
        cv2.imwrite(str(tmp_path / f"{i}.png"), rig.take(T_base_door, 0.8, 2.0, 0.05, i, rig_seed=3)["1"])
        pictures.append({"picture": f"{i}.png", "move": list(move)})
    moves, out = tmp_path / "moves.yaml", tmp_path / "camera.yaml"
    document = {"width": 800, "height": 2000, "thickness": 50, "pictures": pictures}
    moves.write_text(yaml.safe_dump(document), encoding="utf-8")
    assert main(["extrinsics", str(moves), "--out", str(out)]) == 0
    np.testing.assert_allclose(load_camera(out).position, load_camera().position, atol=4e-4)
    y, z, rotation = load_settings(out).mounting_deviation
    assert 1e-6 < max(y, z) < 2e-4  # one thickness: what lens and thickness do to a thick door is in it
    assert 1e-5 < rotation < 5e-4
    text = capsys.readouterr().out
    assert "scale along y: 0.10" in text
    assert "add a picture of a door 30 mm thicker or thinner" in text
    tested = [line for line in text.splitlines() if "moved by y, z = " in line]
    assert len(tested) == 2
    assert all(line.endswith(": right") for line in tested)
    check_and_put_back(tmp_path, moves, out, capsys)


def check_and_put_back(tmp_path, moves, out, capsys):
    """The check of the thesis on the right camera and on one 3 % too long; the first one put back."""
    assert main(["check", str(moves), "--camera", str(out)]) == 0
    good = out.read_bytes()
    document = yaml.safe_load(good)
    for i in (0, 1):
        document["intrinsics"]["k"][i][i] *= 1.03
    spoilt = tmp_path / "spoilt.yaml"
    spoilt.write_text(yaml.safe_dump(document), encoding="utf-8")
    capsys.readouterr()
    assert main(["check", str(moves), "--camera", str(spoilt)]) == 1
    assert "WRONG: calibrate again" in capsys.readouterr().out
    ros = tmp_path / "ros.yaml"
    assert main(["export", "--camera", str(spoilt), "--name", "face", "--out", str(ros)]) == 0
    assert main(["import", str(ros), "--camera", str(out), "--out", str(out)]) == 0
    assert "calibrate restore" in capsys.readouterr().out
    np.testing.assert_allclose(load_camera(out).k, load_camera(spoilt).k)
    assert load_camera(out).position == pytest.approx(document_position(document))
    assert main(["restore", str(out)]) == 0
    assert out.read_bytes() == good
    assert main(["restore", str(out), "--list"]) == 0
    assert capsys.readouterr().out.count(".yaml.kept") == 3
    assert main(["restore", str(out), "--number", "7"]) == 2
    assert "number 7 is asked for" in capsys.readouterr().err


def document_position(document):
    return [document["mounting"][name] for name in ("x", "slider_y", "z")]


def test_the_lens_of_the_thesis_is_told_off(capsys):
    assert main(["lens", "0.0206", "10.4073", "-115.4536"]) == 0
    assert "has no ray" in capsys.readouterr().out
    assert main(["lens"]) == 0
    assert "has no ray" not in capsys.readouterr().out
    assert main(["lens", "-0.1", "5e-2", "-1e-3"]) == 0
    assert "a ray to the corner is moved by -39 px" in capsys.readouterr().out


@pytest.mark.parametrize(
    "radial", [("nan", "nan", "nan"), ("1e300", "0", "0"), ("0", "inf", "0"), ("0", "0", "-10000000")]
)
def test_coefficients_that_are_no_numbers_of_a_lens_are_refused(radial, capsys):
    assert main(["lens", *radial]) == 2
    told = capsys.readouterr().err
    assert told.startswith("calibration: the radial coefficients are ")
    assert "allowed are numbers up to 1e+06" in told
    assert told.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--square", "25", "--board", "0", "0"], "a board of 0 x 0 inner corners"),
        (["--square", "25", "--board", "9", "2"], "a board of 9 x 2 inner corners"),
        (["--square", "25", "--board", "-9", "6"], "a board of -9 x 6 inner corners"),
        (["--square", "25", "--board", "1000000", "1000000"], "a board of 1000000 x 1000000 inner corners"),
        (["--square", "25", "--board", "7", "7"], "a board of 7 x 7 inner corners"),
        (["--square", "-25"], "squares of -25 mm"),
        (["--square", "0"], "squares of 0 mm"),
        (["--square", "nan"], "squares of nan mm"),
        (["--square", "inf"], "squares of inf mm"),
        (["--square", "1e300"], "squares of 1e+300 mm"),
    ],
)
def test_a_board_that_is_none_is_refused(options, says, tmp_path, capsys):
    picture = tmp_path / "a.png"
    write_picture(np.full((60, 80, 3), 120, np.uint8), picture)
    assert main(["intrinsics", str(picture), *options, "--out", str(tmp_path / "out.yaml")]) == 2
    told = capsys.readouterr().err
    assert told.startswith("calibration: ")
    assert says in told
    assert "allowed" in told
    assert told.count("\n") == 1
    assert not (tmp_path / "out.yaml").exists()


def test_bad_input_is_told_in_one_sentence(tmp_path, capsys):
    text = tmp_path / "moves.yaml"
    text.write_text("pictures: [{picture: a.png}]\n", encoding="utf-8")
    out = str(tmp_path / "out.yaml")
    for arguments in (
        ["intrinsics", str(text), "--square", "20", "--out", out],
        ["extrinsics", str(text), "--out", out],
        ["extrinsics", str(tmp_path / "none.yaml"), "--out", out],
    ):
        assert main(arguments) == 2
        assert capsys.readouterr().err.startswith("calibration: ")


def test_a_lens_of_which_the_corner_is_open_is_not_written(tmp_path, monkeypatch, capsys):
    """Three radial coefficients from boards near the middle; as files their corners would take long to render."""
    square = np.array([[1700.0, 0.0, 950.0], [0.0, 1700.0, 520.0], [0.0, 0.0, 1.0]])
    seen = [
        BoardPicture(f"{i}.png", c) for i, c in enumerate(held_upright(19, 2, square, distance=(0.8, 1.6)))
    ]
    monkeypatch.setattr(boards, "_from_files", lambda *_: (seen, (1920, 1080)))
    out = tmp_path / "out.yaml"
    command = ["intrinsics", "0.png", "--square", "20", "--radial", "3", "--out", str(out)]
    assert main(command) == 2
    assert "leave open where a ray to the picture's corner lands" in capsys.readouterr().err
    assert not out.exists()
