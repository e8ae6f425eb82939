"""`calibrate empty`: a picture beside the camera file, entered there, that can be replaced and put back."""

from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Surface
from doormill_ros.tools.calibrate import main
from doormill_ros.tools.locate import main as locate

SCENE = PictureScene(0.826, 0.04, background=Surface(0.2, mottle=0.05, mottle_size=4e-3), door=False)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Pictures of a clamp, of it in other light, and of a door in it."""
    folder = tmp_path_factory.mktemp("pictures")
    scenes = {
        "empty": SCENE,
        "dim": replace(SCENE, light=replace(SCENE.light, level=0.8)),
        "door": replace(SCENE, door=True),
    }
    for name, scene in scenes.items():
        picture = render_picture(scene, 1)
        write_picture(np.repeat(picture[..., None], 3, axis=2), folder / f"{name}.png")
    return {name: str(folder / f"{name}.png") for name in scenes}


def test_a_picture_is_kept_beside_the_file_replaced_and_put_back(tmp_path, files, capsys):
    out = tmp_path / "camera.yaml"
    assert main(["empty", files["empty"], "--width", "826", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "the empty clamp for doors of 826 mm: 1 picture, noise 1." in said
    (entry,) = yaml.safe_load(out.read_text(encoding="utf-8"))["empty_clamp"]
    assert entry["picture"] == "camera.yaml.empty/001.png"
    assert entry["taken"] == load_camera(out).empty[0].taken
    assert date.fromisoformat(entry["taken"])
    first = load_camera(out).empty[0].picture
    np.testing.assert_array_equal(first, read_picture(Path(files["empty"])))

    again = ["--camera", str(out), "--out", str(out)]
    assert main(["empty", files["dim"], "--width", "826", *again]) == 0
    assert "calibrate restore" in capsys.readouterr().out
    assert main(["empty", files["empty"], files["empty"], "--width", "726", *again]) == 0
    found = load_camera(out).empty
    assert [clamp.width for clamp in found] == [0.726, 0.826]
    assert found[1].picture.mean() < 0.9 * first.mean()

    assert main(["restore", str(out), "--number", "1"]) == 0
    (clamp,) = load_camera(out).empty
    np.testing.assert_array_equal(clamp.picture, first)


def test_the_picture_goes_along_with_a_file_that_is_written_elsewhere(tmp_path, files):
    out, other = tmp_path / "camera.yaml", tmp_path / "other" / "camera.yaml"
    assert main(["empty", files["empty"], "--width", "826", "--out", str(out)]) == 0
    ros = tmp_path / "ros.yaml"
    assert main(["export", "--out", str(ros)]) == 0
    other.parent.mkdir()
    assert main(["import", str(ros), "--camera", str(out), "--out", str(other)]) == 0
    assert load_camera(other).empty[0].width == 0.826


def test_the_localizer_uses_it(tmp_path, files, capsys):
    """A plate looks as a door does: whoever is sure that the clamp is empty makes it known."""
    out = tmp_path / "camera.yaml"
    size = ["--size", "826", "2040", "40"]
    assert main(["empty", files["door"], "--width", "826", "--sure", "--out", str(out)]) == 0
    capsys.readouterr()
    assert locate([*size, files["door"]]) == 0
    assert "refused" not in capsys.readouterr().out
    assert locate([*size, files["door"], "--camera", str(out)]) == 0
    assert "refused, 218 NoDoor: no door stands there" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["door", "--width", "826"], "what looks like the corner of a door stands at u = "),
        (["empty", "--width", "9"], "a door of 9 mm, allowed are 100 to 3000 mm"),
        (["--width", "826"], "neither pictures nor a topic were given"),
        (
            ["--width", "826", "--topic", "/a", "--count", "0"],
            "0 pictures are asked for, allowed are 1 to 100",
        ),
        (["empty", "--width", "826", "--count", "3"], "--count was given with files"),
        (
            ["empty", "--width", "826", "--topic", "/a", "--wait", "1"],
            "1 pictures and the topic /a were given",
        ),
    ],
)
def test_a_refusal_is_one_sentence_and_writes_nothing(arguments, said, tmp_path, files, capsys):
    out = tmp_path / "camera.yaml"
    assert main(["empty", *(files.get(a, a) for a in arguments), "--out", str(out)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("calibration: ")
    assert said in line
    assert list(tmp_path.iterdir()) == []
