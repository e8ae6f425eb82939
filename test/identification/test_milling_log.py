"""`identify --milling`: from force logs of a milling test to the wrench of a recipe."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.frames import rotate_wrench, rotation_z
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.tools.identify import main
from support.thesis_milling import THESIS_FORCES

ROBOT, MOUNTING = "irb6600_175_255", 0.76878
MASS, CENTRE = 26.0, np.array([0.01, -0.02, 0.14])
OFFSET = np.array([3.0, -8.0, 15.0, 0.4, -0.2, 0.1])
CUTTING = [0.1, 0.2, -0.1, 0.3, 0.5, -0.4]
RESTS = [[0.0] * 6, [0.2, 0.1, 0.0, 1.2, 0.8, 0.0], [0.0, 0.3, -0.2, -0.9, -1.1, 2.0], CUTTING]
RATE = 200  # Hz


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three rests and a cut of the four segments of table 4.8, two seconds each, after an air cut of three."""
    kinematics, rng = Kinematics(load_robot(ROBOT)), np.random.default_rng(8)

    def save(name: str, q: list[float], wrenches: list[tuple[np.ndarray, float]]) -> None:
        R_base_sensor = kinematics.forward(np.array(q))[:3, :3] @ rotation_z(MOUNTING)
        weight = R_base_sensor.T @ [0.0, 0.0, -MASS * 9.80665]
        still = np.concatenate([weight, np.cross(CENTRE, weight)]) + OFFSET
        process = [
            np.tile(rotate_wrench(rotation_z(-MOUNTING), w), (round(t * RATE), 1)) for w, t in wrenches
        ]
        values = np.concatenate(process) + still
        values += rng.normal(0.0, [1.0] * 3 + [0.1] * 3, values.shape)
        np.savetxt(tmp_path / name, np.column_stack([np.arange(len(values)) / RATE, values]), delimiter=",")

    table = [(np.array(row), 2.0) for row in THESIS_FORCES.values()]
    save("cut.csv", CUTTING, [(np.zeros(6), 3.0), *table])
    for number, q in enumerate(RESTS):
        save(f"rest_{number}.csv", q, [(np.zeros(6), 4.0)])
    return tmp_path


def describe(folder: Path, **changes) -> Path:
    document = {
        "schema": "doormill/milling-log/1",
        "robot": ROBOT,
        "wrench_frame_rotation": MOUNTING,
        "file": "cut.csv",
        "q": CUTTING,
        "segments": {name: [3.0 + 2.0 * i, 5.0 + 2.0 * i] for i, name in enumerate(THESIS_FORCES)},
        "rest": [{"file": f"rest_{number}.csv", "q": q} for number, q in enumerate(RESTS)],
    } | changes
    document = {key: value for key, value in document.items() if value is not None}
    (folder / "milling_log.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
    return folder


def check(written: dict) -> None:
    assert list(written["wrench_n_nm"]) == list(THESIS_FORCES)
    found = np.array(list(written["wrench_n_nm"].values()))
    assert np.abs(found - np.array(list(THESIS_FORCES.values()))).max() < 1.0
    assert written["wrench_point_mm"] == pytest.approx(208, abs=3)


def test_a_milling_test_becomes_the_wrench_of_a_recipe(folder, capsys):
    assert main(["--milling", str(describe(folder)), "--out", str(folder / "out")]) == 0
    printed = capsys.readouterr().out
    assert "spindle 26.0" in printed
    assert "(10, -20, 140) mm" in printed
    assert [line.split()[0] for line in printed.splitlines()[2:6]] == list(THESIS_FORCES)
    written = yaml.safe_load((folder / "out" / "wrench.yaml").read_text())
    check(written)
    document = copy.deepcopy(load_recipe("thesis_190_0deg").to_document())
    table = document["features"][0]["wrench_n_nm"] | written["wrench_n_nm"]
    document["features"][0] |= {"wrench_point_mm": written["wrench_point_mm"], "wrench_n_nm": table}
    feature = Recipe.from_document(document).features[0]
    row = np.array(written["wrench_n_nm"]["left_line"])
    # What the sensor reads as a moment is the force at the tip of the tool, to 1 %.
    assert np.abs(feature.wrench("left_line")[3:5]).max() < 0.03 * np.abs(row[3:5]).max() + 1.0


def test_an_air_cut_stands_for_the_rests(folder, capsys):
    describe(folder, rest=None, q=None, air=[0.0, 3.0])
    assert main(["--milling", str(folder), "--out", str(folder / "out")]) == 0
    assert "spindle" not in capsys.readouterr().out
    check(yaml.safe_load((folder / "out" / "wrench.yaml").read_text()))


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"schema": "doormill/milling-log/2"}, "schema is 'doormill/milling-log/2'"),
        ({"robot": "r2d2"}, "robot cannot be used"),
        ({"file": "none.csv"}, "none.csv"),
        ({"segments": {}}, "segments is {}, allowed are names with start and end"),
        ({"segments": {"left_line": [3.0]}}, "segments.left_line is [3.0], allowed are 2 finite numbers"),
        ({"segments": {"left_line": [5.0, 3.0]}}, "allowed is 0 <= start < end"),
        ({"segments": {"left_line": [90.0, 93.0]}}, "the log"),
        ({"rest": None}, "rest or air must be given"),
        ({"air": [0.0, 3.0]}, "rest or air must be given, and not both"),
        ({"rest": 3}, "rest is 3, allowed is a list"),
        ({"rest": ["rest_0.csv"]}, "it needs file and q"),
        ({"rest": [{"file": "rest_0.csv", "q": [1, 2]}]}, "allowed are 6 finite numbers"),
        ({"rest": [{"file": "rest_0.csv", "q": RESTS[0]}]}, "at least three"),
    ],
)
def test_what_cannot_be_used_is_one_line(folder, capsys, changes, problem):
    assert main(["--milling", str(describe(folder, **changes)), "--out", str(folder / "out")]) == 2
    line = capsys.readouterr().err
    assert problem in line
    assert line.count("\n") == 1
    assert not (folder / "out").exists()
