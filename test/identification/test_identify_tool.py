"""The identify tool from the command line: files it writes, and one line when it cannot."""

from __future__ import annotations

import json
import re
import shutil

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.tools.identify import main
from support.full_disk import room_for

TRUE = np.array([3.1e6, 1.7e6, 2.2e6, 2.6e5, 1.6e5, 6.1e4])


def test_measurement_set(tmp_path, make_set, capsys):
    truth = make_set(TRUE, seed=2)
    out = tmp_path / "out"
    assert main(["--data", str(truth.folder), "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "chi-square per degree of freedom" in printed.out
    assert "diagnose" not in printed.out
    assert printed.err == ""
    document = json.loads((out / "identification.json").read_text())
    assert document["schema"] == "doormill/identification/1"
    pulls = (np.array(document["stiffness"]) - TRUE) / np.array(document["std"])
    assert np.abs(pulls).max() < 4.5
    assert sorted(step["joint"] for step in document["one_by_one"]) == [1, 2, 3, 4, 5, 6]
    # The robot file is a robot: it loads, and the spring model takes it.
    robot = load_robot(out)
    assert robot.stiffness == pytest.approx(document["stiffness"], rel=1e-5)
    assert robot.provenance["stiffness"].measured
    shipped = load_robot("irb6600_175_255")
    assert np.array_equal(robot.dh, shipped.dh)
    assert robot.lower == pytest.approx(shipped.lower, abs=1e-9)
    weight = np.array([[0, 0, -1000.0, 0, 0, 0]])
    q = np.array([[0.0, 0.2, 0.1, 0.0, 0.3, 0.0]])
    soft = JointSpringModel(robot).deflection(q, weight, np.zeros(3))
    assert not np.allclose(soft, JointSpringModel(shipped).deflection(q, weight, np.zeros(3)), rtol=1e-3)


def test_misfit_points_to_diagnose(tmp_path, make_set, capsys):
    """Noise declared a tenth of what it is: six springs cannot explain the set."""
    truth = make_set(TRUE, seed=4)
    path = truth.folder / "set.yaml"
    path.write_text(path.read_text().replace("displacement: 8.0e-06", "displacement: 8.0e-07"))
    assert "8.0e-07" in path.read_text()
    assert main(["--data", str(truth.folder), "--out", str(tmp_path / "out")]) == 0
    assert "run `diagnose`" in capsys.readouterr().out


def test_joints_that_are_not_told_keep_the_robots(tmp_path, make_set, capsys):
    truth = make_set(TRUE, seed=1)
    path = truth.folder / "trials.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([lines[0], *(line for line in lines if ",elbow," in line)]) + "\n")
    out = tmp_path / "out"
    assert main(["--data", str(truth.folder), "--out", str(out)]) == 0
    assert "not told" in capsys.readouterr().out
    document = json.loads((out / "identification.json").read_text())
    assert [k is not None for k in document["stiffness"]] == [True, True, False, False, False, False]
    robot, shipped = load_robot(out), load_robot("irb6600_175_255")
    assert np.array_equal(robot.stiffness[2:], shipped.stiffness[2:])
    assert "joints 3, 4, 5, 6 were not told" in robot.provenance["stiffness"].source


def test_thesis(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["--thesis", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    document = json.loads((out / "identification.json").read_text())
    assert len(document["contradictions"]) == 18
    for row in document["simulation_against_measurement"]:
        assert f"{row['measured'] * 1e6:.1f}" in printed
    assert load_robot(out).stiffness == pytest.approx(load_robot("irb6600_175_255").stiffness, rel=5e-4)


def wrong_command(tmp_path, make_set):
    truth = make_set(TRUE)
    (truth.folder / "trials.csv").write_text(
        (truth.folder / "trials.csv").read_text().replace("base", "vase", 1)
    )
    no_yaml = tmp_path / "no_yaml"
    shutil.copytree(truth.folder, no_yaml)
    (no_yaml / "set.yaml").unlink()
    return {
        "no folder": (["--data", str(tmp_path / "nowhere")], "set.yaml: line 1, column 1"),
        "bad cell": (["--data", str(truth.folder)], r"trials\.csv: line 2, column \w+.*vase"),
        "no yaml": (["--data", str(no_yaml)], "set.yaml"),
        "no raw yaml": (["--raw", str(tmp_path)], "loading_tests.yaml: line 1, column 1"),
        "nothing": ([], "required"),
        "two": (["--thesis", "--data", "x"], "not allowed"),
    }


@pytest.mark.parametrize("case", ["no folder", "bad cell", "no yaml", "no raw yaml", "nothing", "two"])
def test_bad_input_is_one_line_and_writes_nothing(tmp_path, make_set, capsys, case):
    arguments, pattern = wrong_command(tmp_path, make_set)[case]
    out = tmp_path / "out"
    assert main([*arguments, "--out", str(out)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert re.search(pattern, printed.err)
    assert not out.exists()


def test_a_full_disk_leaves_the_earlier_identification(tmp_path, capsys):
    earlier = {"identification.json": b"{}", "robot.yaml": b"robot: earlier", "robot.urdf": b"<robot/>"}
    for name, content in earlier.items():
        (tmp_path / name).write_bytes(content)
    with room_for(2000):
        assert main(["--thesis", "--out", str(tmp_path)]) == 2
    assert "too large" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == earlier


def test_out_that_is_a_file_is_refused(tmp_path, capsys):
    path = tmp_path / "out"
    path.write_text("mine")
    assert main(["--thesis", "--out", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert path.read_text() == "mine"
