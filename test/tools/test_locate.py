"""The command line: pictures or readings in, a pose or the reason for a refusal out."""

import json
import re

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.door import DoorSize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig
from doormill_ros.simulation.sensors.touch_probe import TouchProbeRig
from doormill_ros.tools.locate import main
from doormill_ros.units import DEG, m_to_mm
from support.source_tree import ROOT

DOOR = DoorSize(width=0.826, height=2.04, thickness=0.040)
SIZE = ("--size", "826", "2040", "40")
OFFSET, FAR, BESIDE = (
    DoorOffset(0.003, -0.002, 0.01),
    DoorOffset(0.012, -0.002, 0.01),
    DoorOffset(0.0031, -0.002, 0.01),
)
T_BASE_DOOR = load_layout().T_base_door(DOOR.width, DOOR.thickness, OFFSET)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """The door of docs/localization.md three times, one too far off, and one that moved by a tenth of a millimetre."""
    cv2.setNumThreads(1)
    folder = tmp_path_factory.mktemp("pictures")
    for name, offset, seed in (
        ("1", OFFSET, 1),
        ("2", OFFSET, 2),
        ("3", OFFSET, 3),
        ("far", FAR, 3),
        ("beside", BESIDE, 4),
    ):
        picture = render_picture(PictureScene(DOOR.width, DOOR.thickness, offset), seed)
        cv2.imwrite(str(folder / f"{name}.png"), picture)
    return folder


def run(capsys, *arguments):
    code = main([str(a) for a in arguments])
    return code, *capsys.readouterr()


def section(page, title):
    """A section of a page of the docs."""
    return (ROOT / "docs" / page).read_text(encoding="utf-8").split(f"## {title}\n")[1].split("\n## ")[0]


def without_digits(text):
    return re.sub(r"[0-9]+", "0", text)


def test_the_example_of_the_page_comes_out(pictures, capsys):
    printed = re.findall(r"```\n(door of.*?)```", section("localization.md", "From files"), flags=re.DOTALL)
    assert len(printed) == 1
    code, out, err = run(capsys, *SIZE, *(pictures / f"{n}.png" for n in ("1", "2", "3", "far")))
    assert (code, err) == (0, "")
    # Its last digits are the machine's; the refusal has none of those.
    assert without_digits(out) == without_digits(printed[0])
    found, shown = (
        [float(x) for line in text.splitlines() if "+-" in line for x in re.findall(r"[-+]?\d+\.\d+", line)]
        for text in (out, printed[0])
    )
    assert len(found) == 18
    assert found == pytest.approx(shown, abs=5e-4)
    assert [x for x in out.splitlines() if "refused" in x] == [
        x for x in printed[0].splitlines() if "refused" in x
    ]


def test_the_json_holds_pose_deviation_and_refusal_in_si(pictures, tmp_path, capsys):
    out = tmp_path / "out.json"
    assert run(capsys, *SIZE, pictures / "1.png", pictures / "far.png", "--json", out)[0] == 0
    document = json.loads(out.read_text())
    assert (document["schema"], document["frame"]) == ("doormill/located-doors/1", "base_link")
    found, refused = document["readings"]
    assert found["accepted"] is True
    np.testing.assert_allclose(found["T_base_door"], T_BASE_DOOR, atol=5e-5)  # five of its own deviations
    assert found["offset"]["y"] == pytest.approx(OFFSET.y, abs=5e-6)
    assert found["offset"]["rotation"] == pytest.approx(OFFSET.rotation, abs=0.002 * DEG)
    assert found["deviation"]["y"] == pytest.approx(np.sqrt(found["covariance"][0][0]))
    assert 0.0 < found["residual"] < 2e-5
    assert 0.5 < found["quality"] <= 1.0
    assert (refused["accepted"], refused["error_code"], refused["error"]) == (False, 204, "OutOfRange")
    assert refused["reason"].startswith("the door stands +12.00 mm in y")
    assert "repeatability" not in document  # of one that was found


def test_a_door_that_moved_is_more_than_the_covariance_allows(pictures, tmp_path, capsys):
    still, moved = (
        run(capsys, *SIZE, *(pictures / f"{n}.png" for n in names))[1]
        for names in (("1", "2", "3"), ("1", "2", "beside"))
    )
    assert "the spread is no more than the stated covariance allows" in still
    assert "the spread is MORE than the stated covariance allows" in moved


def test_the_overlay_is_drawn(pictures, tmp_path, capsys):
    assert run(capsys, *SIZE, pictures / "1.png", "--overlay", tmp_path / "one.png")[0] == 0
    assert (
        run(capsys, *SIZE, pictures / "1.png", pictures / "far.png", "--overlay", tmp_path / "two.png")[0]
        == 0
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["one.png", "two-1.png", "two-2.png"]
    drawn = cv2.imread(str(tmp_path / "one.png"))
    assert drawn.shape == (1080, 1920, 3)
    assert np.count_nonzero(drawn[..., 1].astype(int) - drawn[..., 0] > 80) > 500  # rings and lines


def test_the_overlay_of_a_refusal_has_its_sentence(pictures, tmp_path, capsys):
    assert run(capsys, *SIZE, pictures / "far.png", "--overlay", tmp_path / "far.png")[0] == 0
    plain, drawn = (cv2.imread(str(folder / "far.png")).astype(int) for folder in (pictures, tmp_path))
    assert drawn.shape == plain.shape
    assert np.count_nonzero((drawn[:200, :760] > 240).all(axis=2)) > 500  # letters
    np.testing.assert_array_equal(drawn[400:], plain[400:])


def test_a_deep_picture_is_read_as_the_node_reads_it(pictures, tmp_path, capsys):
    grey = cv2.imread(str(pictures / "1.png"), cv2.IMREAD_GRAYSCALE)
    deep = grey.astype(np.uint16) << 4  # 12 of 16 bit
    assert cv2.imwrite(str(tmp_path / "1.png"), deep)
    out = tmp_path / "out.json"
    assert run(capsys, *SIZE, tmp_path / "1.png", pictures / "1.png", "--json", out)[0] == 0
    deep_found, found = json.loads(out.read_text())["readings"]
    np.testing.assert_allclose(deep_found["T_base_door"], found["T_base_door"], atol=3e-6)


def test_a_door_comes_from_the_database_or_from_a_file(pictures, tmp_path, capsys):
    file = ROOT / "config" / "recipes" / "standard_door.yaml"
    recipe = load_recipe("standard_door")
    cv2.imwrite(
        str(tmp_path / "a.png"), render_picture(PictureScene(recipe.width, recipe.thickness, OFFSET), 5)
    )
    by_id = run(capsys, "--door", "standard_door", tmp_path / "a.png")
    assert by_id == run(capsys, "--door", file, tmp_path / "a.png")
    assert by_id[0] == 0
    assert f"door of {m_to_mm(recipe.width):g} x" in by_id[1]
    assert "quality" in by_id[1]


def test_a_camera_file_is_believed(pictures, tmp_path, capsys):
    document = yaml.safe_load((ROOT / "config" / "camera.yaml").read_text())
    document["mounting"]["z"] += 0.001
    (tmp_path / "camera.yaml").write_text(yaml.safe_dump(document))
    out = tmp_path / "out.json"
    assert run(capsys, *SIZE, "--camera", tmp_path / "camera.yaml", pictures / "1.png", "--json", out)[0] == 0
    [found] = json.loads(out.read_text())["readings"]
    assert found["offset"]["z"] == pytest.approx(OFFSET.z + 0.001, abs=2e-5)


def readings_of(name, folder):
    """A file with two readings of the door, and what the sensor itself makes of the first."""
    size = (DOOR.width, DOOR.height, DOOR.thickness)
    if name == "one_camera":
        picture = render_picture(PictureScene(DOOR.width, DOOR.thickness, OFFSET), 1)
        cv2.imwrite(str(folder / "a.png"), picture)
        return [folder / "a.png", folder / "a.png"], picture
    if name == "axis_vision":
        takes = [AxisVisionRig.load().take(T_BASE_DOOR, *size, seed=seed) for seed in (1, 2)]
        rows = [{camera: f"{i}-{camera}.png" for camera in take} for i, take in enumerate(takes)]
        for take, row in zip(takes, rows, strict=True):
            for camera, picture in take.items():
                cv2.imwrite(str(folder / row[camera]), picture)
        document, first = {"pictures": rows}, takes[0]
    elif name == "photoelectric":
        takes = [PhotoelectricRig.load().read(T_BASE_DOOR, *size, seed=seed) for seed in (1, 2)]
        document, first = {"distances_mm": [m_to_mm(t).tolist() for t in takes]}, takes[0]
    else:
        takes = [TouchProbeRig.load().touch(T_BASE_DOOR, *size, seed=seed, count=8) for seed in (1, 2)]
        document, first = {"points_mm": [m_to_mm(t).tolist() for t in takes]}, takes[0]
    (folder / "readings.yaml").write_text(yaml.safe_dump(document))
    return [folder / "readings.yaml"], first


@pytest.mark.parametrize("name", sorted(SENSORS))
def test_every_sensor_reads_its_files(name, tmp_path, capsys):
    files, first = readings_of(name, tmp_path)
    out = tmp_path / "out.json"
    code, text, _ = run(capsys, *SIZE, "--sensor", name, *files, "--json", out)
    assert code == 0
    document = json.loads(out.read_text())
    assert document["sensor"] == name
    assert len(document["readings"]) == 2
    assert "repeatability of 2" in text
    expected = SENSORS[name]().locate(first, DOOR)
    found = document["readings"][0]
    np.testing.assert_allclose(found["T_base_door"], expected.T_base_door, atol=1e-9)
    np.testing.assert_allclose(found["covariance"], expected.covariance, rtol=1e-6, atol=1e-16)
    assert found["blind"] == [freedom.replace(" ", "_") for freedom in expected.blind]
    assert abs(found["offset"]["y"] - OFFSET.y) < 4 * found["deviation"]["y"]
    assert abs(found["offset"]["rotation_x"] - OFFSET.rotation) < 4 * found["deviation"]["rotation_x"]
    assert text.count("not measured") == 2 * len(expected.blind)


def test_the_readings_on_the_page_are_read(tmp_path, capsys):
    text = section("sensors.md", "From files")
    blocks = re.findall(r"```yaml\n(.*?)```", text, flags=re.DOTALL)
    assert [list(yaml.safe_load(block)) for block in blocks] == [
        ["distances_mm"],
        ["points_mm"],
        ["pictures"],
    ]
    (tmp_path / "distances.yaml").write_text(blocks[0])
    (tmp_path / "points.yaml").write_text(blocks[1])
    command = re.search(r"`locate (.*? distances\.yaml)`", text)[1].split()
    code, out, _ = run(capsys, *command[:-1], tmp_path / command[-1])
    assert code == 0
    assert out in text
    code, out, _ = run(capsys, "--sensor", "touch_probe", *SIZE, tmp_path / "points.yaml")
    assert code == 0
    assert out.count("+-") == 6


def test_a_sensor_that_sees_no_door_refuses(tmp_path, capsys):
    (tmp_path / "d.yaml").write_text("distances_mm: [[55.0, 55.0, 55.0, 55.0, .nan, 55.0]]\n")
    code, out, _ = run(capsys, *SIZE, "--sensor", "photoelectric", tmp_path / "d.yaml")
    assert code == 0
    assert "d.yaml: refused, 223 BeamMissed: distance sensor 5" in out


def test_input_that_cannot_be_used_is_told_in_one_line(pictures, tmp_path, capsys):
    picture = pictures / "1.png"
    (tmp_path / "text.png").write_text("no picture")
    (tmp_path / "two.yaml").write_text("distances_mm: [[1, 2]]\npoints_mm: []\n")
    (tmp_path / "words.yaml").write_text("distances_mm: [[near, far]]\n")
    (tmp_path / "flat.yaml").write_text("points_mm: [[1, 2, 3]]\n")
    (tmp_path / "broken.yaml").write_text("distances_mm: [[1, 2\n")
    (tmp_path / "camera.yaml").write_text("size: [1920, 1080]\n")
    cases = [
        (*SIZE, tmp_path / "none.png"),
        (*SIZE, tmp_path / "text.png"),
        (*SIZE, picture, "--camera", tmp_path / "camera.yaml"),
        (*SIZE, picture, "--overlay", tmp_path / "o.txt"),
        (*SIZE, picture, "--json", tmp_path / "no folder" / "o.json"),
        (*SIZE, picture, "--config", tmp_path / "camera.yaml"),
        (*SIZE, picture, "--sensor", "nose"),
        ("--size", "826", "2040", "-40", picture),
        ("--door", "no_such_door", picture),
        ("--door", tmp_path / "none.yaml", picture),
        (picture,),
        *(
            (*SIZE, "--sensor", sensor, tmp_path / f"{name}.yaml")
            for sensor, name in (
                ("photoelectric", "two"),
                ("photoelectric", "words"),
                ("photoelectric", "broken"),
                ("photoelectric", "none"),
                ("touch_probe", "flat"),
                ("axis_vision", "two"),
            )
        ),
    ]
    assert len(cases) == 17
    for arguments in cases:
        code, out, err = run(capsys, *arguments)
        assert (code, out) == (2, ""), arguments
        assert err.startswith("locate: "), arguments
        assert err.count("\n") == 1, arguments


def test_a_reading_that_is_wrong_is_told_with_its_place(tmp_path, capsys):
    (tmp_path / "d.yaml").write_text("distances_mm: [[1, 2, 3], [1, near, 3]]\n")
    err = run(capsys, *SIZE, "--sensor", "photoelectric", tmp_path / "d.yaml")[2]
    assert "d.yaml: distances_mm.1.1 is 'near', allowed is a number of millimetres, .nan for" in err


@pytest.mark.parametrize(
    ("files", "options"),
    [
        (["in.png"], ["--overlay", "in.png"]),
        (["in.png"], ["--json", "in.png"]),
        (["in.png"], ["--json", "linked.png"]),
        (["in.png", "in-1.png"], ["--overlay", "in.png"]),
        (["in.png"], ["--json", "out.png", "--overlay", "out.png"]),
    ],
)
def test_what_is_read_is_not_written_over(files, options, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("in.png", "in-1.png"):
        cv2.imwrite(name, np.full((48, 64), 90, np.uint8))
    (tmp_path / "linked.png").symlink_to(tmp_path / "in.png")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    code, out, err = run(capsys, *SIZE, *files, *options)
    assert (code, out) == (2, "")
    assert "is to be written and is " in err
    assert err.count("\n") == 1
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize("option", ["--json", "--overlay"])
def test_a_folder_as_an_output_is_told(option, pictures, capsys):
    for files in (["1"], ["1", "2"]):
        code, out, err = run(capsys, *SIZE, *(pictures / f"{n}.png" for n in files), option, ".")
        assert (code, out) == (2, "")
        assert err.startswith("locate: ")
        assert err.count("\n") == 1
