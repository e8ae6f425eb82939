"""`diagnose --pictures`: a folder of pictures in, the wrong part of the camera model out."""

import json

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.camera.causes import camera_causes
from doormill_ros.tools.diagnose import main
from support.pictures.moved_door import EVERY, THICKNESS, WIDTH
from support.source_tree import ROOT

CAMERA = yaml.safe_load((ROOT / "config" / "camera.yaml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def pictures(photographed, tmp_path_factory):
    """The folder of a picture set without set.yaml."""
    folder = tmp_path_factory.mktemp("pictures")
    lines = ["picture,t,y,z,rotation"]
    for i, (offset, picture) in enumerate(zip(*photographed, strict=True)):
        cv2.imwrite(str(folder / f"{i:02d}.png"), picture)
        lines.append(
            f"{i:02d}.png,{i * EVERY},{offset.y!r},{offset.z!r},{offset.rotation!r}".replace("np.float64", "")
        )
    text = "\n".join(lines).replace("(", "").replace(")", "") + "\n"
    (folder / "pictures.csv").write_text(text)
    return folder


def describe(folder, camera=None):
    """Write set.yaml, and the camera file where one is questioned that is not the cell's."""
    lines = ["schema: doormill/picture-set/1", f"door: {{width: {WIDTH}, thickness: {THICKNESS}}}"]
    if camera is not None:
        (folder / "camera.yaml").write_text(yaml.safe_dump(camera))
        lines.append("camera: camera.yaml")
    (folder / "set.yaml").write_text("\n".join(lines) + "\n")


def copy(folder, to, but):
    """Link the files of a set, but one that is to differ."""
    for path in folder.iterdir():
        if path.name != but:
            (to / path.name).symlink_to(path)


def run(capsys, *arguments):
    code = main([str(a) for a in (*arguments, "--quiet")])
    return code, *capsys.readouterr()


def test_the_camera_of_the_cell_is_consistent(pictures, tmp_path, capsys):
    describe(pictures)
    code, out, err = run(capsys, "--pictures", pictures, "--out", tmp_path)
    assert (code, err) == (0, "")
    assert out.startswith("consistent: the residual is ")
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    assert document["schema"] == "doormill/diagnosis/1"
    assert document["verdict"] == "consistent"
    assert document["causes"] == []
    assert document["refused"] == []
    assert document["pictures"] == 24
    assert document["baseline"] == document["extended"]
    assert document["gain"]["holdout_rmse_ratio"] == 1.0
    # These edges are perfectly straight, the localizer allows for a saw's.
    assert 0.2 < document["baseline"]["holdout_rmse"] < 1.2


def test_a_wrong_focal_length_is_named_and_sized(pictures, tmp_path, capsys):
    k = (np.array(CAMERA["intrinsics"]["k"]) * [[1.01, 1.0, 1.0], [1.0, 1.01, 1.0], [1.0, 1.0, 1.0]]).tolist()
    describe(pictures, CAMERA | {"intrinsics": CAMERA["intrinsics"] | {"k": k}})
    code, out, _ = run(capsys, "--pictures", pictures, "--out", tmp_path)
    assert code == 0
    assert out.startswith("explained: camera_placing and camera_scale; held-out residual ")
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    placing, scale = document["causes"]
    assert (scale["cause"], scale["where"], scale["confusable_with"]) == ("camera_scale", "camera", [])
    factor = scale["parameters"]["factor_error"]
    assert abs(factor["value"] - (1 / 1.01 - 1)) < 4.0 * factor["std"]
    assert factor["unit"] == "1"
    assert "distance" in scale["pattern"]
    assert len(placing["parameters"]["offset"]["value"]) == len(placing["parameters"]["offset"]["std"]) == 3
    before, after = (document[model]["holdout_rmse"] for model in ("baseline", "extended"))
    assert after < 2.0 < before
    assert (document["unit"], document["noise_floor"]) == ("standard deviations of one localization", 1.0)
    assert len(document["margins"]) > 3
    assert "extended_model" not in document, (
        "nothing else can use a model of the camera: it is calibrated again"
    )
    assert {path.name for path in tmp_path.iterdir()} == {"diagnosis.json", "report.html"}
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    told = "times the localizer's own uncertainty".replace("'", "&#39;")
    assert (
        f"<h1>Explained: camera placing and camera scale ({before:.2f} {told} down to {after:.2f} {told})</h1>"
        in page
    )
    assert "<td>camera scale</td>" in page


def test_a_picture_without_a_door_is_told_and_left_out(pictures, tmp_path, capsys):
    describe(pictures)
    copy(pictures, tmp_path, "05.png")
    cv2.imwrite(str(tmp_path / "05.png"), np.full((1080, 1920), 40, np.uint8))
    code, out, _ = run(capsys, "--pictures", tmp_path, "--out", tmp_path / "out")
    assert code == 0
    assert out.startswith("consistent")
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert document["pictures"] == 23
    [refused] = document["refused"]
    assert (refused["picture"], refused["error_code"]) == ("05.png", 201)
    assert refused["reason"].startswith("no line")


@pytest.mark.parametrize(
    ("file", "old", "new", "complaint"),
    [
        (
            "set.yaml",
            "picture-set/1",
            "picture-set/9",
            "set.yaml: line 1, column 9: schema is 'doormill",
        ),
        ("set.yaml", "thickness: 0.04", "thickness: -1", "set.yaml: line 2, column 31: door.thickness is -1"),
        (
            "set.yaml",
            "door:",
            "camera: none.yaml\ndoor:",
            "set.yaml: line 2, column 9: camera is 'none.yaml'",
        ),
        ("pictures.csv", "t,y,z", "t,y,x", "pictures.csv: line 1, column z: the column is missing"),
        ("pictures.csv", "00.png,0.0", "00.png,99.0", "pictures.csv: line 3, column t: 30 follows 99"),
        ("pictures.csv", "03.png", "none.png", "pictures.csv: line 5, column picture: 'none.png' is no PNG"),
    ],
)
def test_a_set_that_cannot_be_read_is_told_with_line_and_column(
    pictures, tmp_path, capsys, file, old, new, complaint
):
    describe(pictures)
    copy(pictures, tmp_path, file)
    text = (pictures / file).read_text()
    assert text.count(old) == 1
    (tmp_path / file).write_text(text.replace(old, new))
    code, out, err = run(capsys, "--pictures", tmp_path, "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert complaint in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_door_that_was_hardly_moved_is_told(pictures, tmp_path, capsys):
    describe(pictures)
    copy(pictures, tmp_path, "pictures.csv")
    rows = (pictures / "pictures.csv").read_text().splitlines()
    (tmp_path / "pictures.csv").write_text("\n".join(rows[:4]) + "\n")
    code, _, err = run(capsys, "--pictures", tmp_path, "--out", tmp_path / "out")
    assert code == 2
    assert "3 of 3 pictures show the door, at fewer than 4 places" in err


def test_the_page_describes_the_set_as_it_is_read(pictures, tmp_path, capsys):
    page = (ROOT / "docs" / "calibration.md").read_text(encoding="utf-8")
    text = page.split("## Is it still right?\n")[1].split("\n## ")[0]
    description, table = (
        text.split("```yaml\n")[1].split("```")[0],
        text.split("```\npicture,")[1].split("```")[0],
    )
    copy(pictures, tmp_path, "pictures.csv")
    (tmp_path / "set.yaml").unlink(missing_ok=True)
    (tmp_path / "set.yaml").write_text(description)
    (tmp_path / "camera.yaml").unlink(missing_ok=True)
    (tmp_path / "camera.yaml").write_text(yaml.safe_dump(CAMERA))
    rows = (pictures / "pictures.csv").read_text().splitlines()
    assert rows[0] == "picture," + table.splitlines()[0]
    (tmp_path / "pictures.csv").write_text("\n".join(rows) + "\n")
    code, out, _ = run(capsys, "--pictures", tmp_path, "--out", tmp_path / "out")
    assert code == 0
    assert out.startswith("consistent")
    for cause in camera_causes():
        assert f"`{cause.name}`" in text, cause.name
        assert cause.parameters[0].name in text, cause.name
    assert len(camera_causes()) == 7
