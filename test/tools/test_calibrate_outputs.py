"""What the commands of calibrate write over, keep or refuse to write."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.kept import keep, kept
from doormill_ros.resources import resource
from doormill_ros.simulation.picture.scene import Sensor
from doormill_ros.tools.calibrate import main
from doormill_ros.tools.calibration import boards, doors
from support.pictures.chessboard import render_chessboard
from support.pictures.chessboard_corners import BOARD, CAMERA, views


def moves(folder: Path, count: int = 2) -> Path:
    entries = [{"picture": f"{i}.png", "move": [0, 10 * i, 0]} for i in range(count)]
    path = folder / "moves.yaml"
    path.write_text(yaml.safe_dump({"width": 800, "height": 2000, "thickness": 50, "pictures": entries}))
    return path


def grey(level: int) -> ByteArray:
    return np.full((1080, 1920), level, np.uint8)


def test_without_a_terminal_no_picture_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, taken = moves(tmp_path), []
    cv2.imwrite(str(tmp_path / "0.png"), grey(9))
    before = (tmp_path / "0.png").read_bytes()
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))

    def shutter() -> ByteArray:
        taken.append(grey(77))
        return taken[-1]

    with pytest.raises(
        BadCalibrationFile, match="nobody pressed Enter for move 0, 10, 0 mm, the input has ended"
    ):
        doors._moved(path, shutter)
    assert len(taken) == 1
    assert (tmp_path / "0.png").read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["0.png", "moves.yaml"]


def test_pictures_that_are_taken_again_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = moves(tmp_path)
    cv2.imwrite(str(tmp_path / "0.png"), grey(9))
    before = (tmp_path / "0.png").read_bytes()
    monkeypatch.setattr("sys.stdin", io.StringIO("\n\n"))
    doors._moved(path, lambda: grey(77))
    assert cv2.imread(str(tmp_path / "0.png"))[3, 3].tolist() == [77, 77, 77]
    assert (tmp_path / "0.png.kept" / "001.png").read_bytes() == before
    assert not (tmp_path / "1.png.kept").exists()


def test_one_file_for_two_moves_is_refused(tmp_path: Path) -> None:
    path = moves(tmp_path)
    path.write_text(path.read_text().replace("1.png", "0.png"))
    with pytest.raises(BadCalibrationFile, match="for two moves"):
        doors._moved(path, lambda: grey(77))


def test_a_folder_with_pictures_is_not_filled_again(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "001.png"), grey(9))
    called: list[bool] = []
    with pytest.raises(BadCalibrationFile, match=r"holds 1 pictures already, such as 001\.png"):
        boards._live(lambda _: called.append(True), BOARD, tmp_path)
    assert not called


def test_an_export_keeps_what_the_file_held(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "camera.yaml"
    out.write_bytes(resource("config/camera.yaml").read_bytes())
    assert main(["export", "--out", str(out)]) == 0
    assert "the file before is kept as " in capsys.readouterr().out
    assert b"camera_matrix" in out.read_bytes()
    assert main(["restore", str(out)]) == 0
    assert out.read_bytes() == resource("config/camera.yaml").read_bytes()


def test_more_than_999_files_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    (tmp_path / "camera.yaml.kept").mkdir()
    for number in (998, 999, 1000):
        (tmp_path / "camera.yaml.kept" / f"{number}.yaml").write_text(f"{number}")
    path.write_text("now")
    assert keep(path) == tmp_path / "camera.yaml.kept" / "1001.yaml"
    assert [p.stem for p in kept(path)] == ["998", "999", "1000", "1001"]


@pytest.mark.parametrize(
    "command",
    [["export", "--out", "."], ["restore", ".", "--list"], ["import", "ros.yaml", "--out", "."]],
)
def test_a_folder_is_no_file_to_write(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["export", "--out", "ros.yaml"]) == 0
    assert main(command) == 2
    told = capsys.readouterr().err
    assert told.startswith("calibration: ")
    assert told.count("\n") == 1


@pytest.mark.parametrize("option", ["--out", "--coverage"])
def test_a_picture_that_is_read_is_not_written_over(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "mine.png"
    cv2.imwrite(str(picture), grey(9))
    before = picture.read_bytes()
    given = {"--out": str(tmp_path / "out.yaml"), "--coverage": str(tmp_path / "cover.png")} | {
        option: str(picture)
    }
    options = [text for pair in given.items() for text in pair]
    assert main(["intrinsics", str(picture), "--square", "20", *options]) == 2
    assert "is to be written and is read as well" in capsys.readouterr().err
    assert picture.read_bytes() == before
    assert list(tmp_path.iterdir()) == [picture]


def test_files_and_topic_together_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["intrinsics", "a.png", "--square", "20", "--out", str(tmp_path / "out.yaml")]
    assert main([*command, "--topic", "/a", "--wait", "1"]) == 2
    assert "1 pictures and the topic /a were given, allowed is one of both" in capsys.readouterr().err
    assert main([*command, "--save", str(tmp_path)]) == 2
    assert "--save was given with files" in capsys.readouterr().err


def test_a_name_that_no_topic_has_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["intrinsics", "--square", "20", "--out", str(tmp_path / "out.yaml"), "--wait", "1"]
    for _ in range(2):  # and nothing of the first is left
        assert main([*command, "--topic", "bad topic"]) == 2
        assert "'bad topic' is no name of a topic, allowed are " in capsys.readouterr().err


def test_pictures_of_one_name_in_two_folders_both_have_their_record(tmp_path: Path) -> None:
    names = []
    for i, view in enumerate(views(8, seed=8)):
        path = tmp_path / f"{i % 2}" / f"{i // 2}.png"
        path.parent.mkdir(exist_ok=True)
        cv2.imwrite(str(path), render_chessboard(CAMERA, view, Sensor(blur=0.8), i))
        names.append(str(path))
    last = tmp_path / "1" / "alone.png"
    (tmp_path / "1" / "3.png").rename(last)
    names[-1] = str(last)
    out = tmp_path / "camera.yaml"
    assert main(["intrinsics", *names, names[0], "--square", "20", "--out", str(out)]) == 0
    record = yaml.safe_load(out.read_text(encoding="utf-8"))["chessboard"]["picture_error"]
    assert set(record) == {*names[:6], "3.png", "alone.png"}
