"""The tool: exit codes, files to the letter of their form, and one page that needs nothing else."""

import json
import re
import shutil

import numpy as np
import pytest

from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.tools.diagnose import main

BACKLASH = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 8e-5, "crossing": 20.0}}


def run(capsys, *arguments):
    code = main([str(a) for a in arguments])
    return code, *capsys.readouterr()


@pytest.fixture
def explained(make_set, tmp_path, capsys):
    data = make_set([BACKLASH], seed=41, trials=80)
    code, out, err = run(capsys, "--data", data.path, "--out", tmp_path / "out")
    assert code == 0
    return data, tmp_path / "out", out, err


def test_the_json_has_the_agreed_form(explained):
    _, out, line, _ = explained
    document = json.loads((out / "diagnosis.json").read_text())
    assert document["schema"] == "doormill/diagnosis/1"
    assert document["verdict"] == "explained"
    assert document["noise_floor"] == pytest.approx(8e-6, rel=0.05)
    for model in ("baseline", "extended"):
        assert set(document[model]) == {"train_rmse", "holdout_rmse"}
    gain = document["gain"]
    assert gain["ci95"][0] <= gain["holdout_rmse_ratio"] <= gain["ci95"][1] < 0.6
    ratio = document["extended"]["holdout_rmse"] / document["baseline"]["holdout_rmse"]
    assert gain["holdout_rmse_ratio"] == pytest.approx(ratio)
    [cause] = document["causes"]
    assert {"cause", "where", "parameters", "holdout_rmse_without", "confusable_with"} == set(cause)
    assert (cause["cause"], cause["where"]) == ("joint_backlash", "joint 1")
    assert set(cause["parameters"]) == {"gap", "crossing"}
    assert cause["parameters"]["gap"]["unit"] == "rad"
    gap = cause["parameters"]["gap"]
    assert abs(gap["value"] - 8e-5) < 3.0 * gap["std"]
    assert cause["holdout_rmse_without"] == pytest.approx(document["baseline"]["holdout_rmse"])
    assert isinstance(document["next_measurement"], str)
    assert document["outliers"] == []
    assert (out / document["extended_model"]).is_file()
    assert line.startswith("explained: joint_backlash at joint 1")


def test_baseline_rmse_is_that_of_all_components(explained):
    """By hand: springs times levers, without the library."""
    data, out, _, _ = explained
    from doormill_ros.robot.kinematics import Kinematics

    document = json.loads((out / "diagnosis.json").read_text())
    frames = Kinematics(data.dh).link_frames(data.q)
    total = 0.0
    for i in range(len(data)):
        T = frames[i]
        c, s = np.cos(data.wrench_frame_rotation), np.sin(data.wrench_frame_rotation)
        R = T[6, :3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        force, couple = R @ data.wrench[i, :3], R @ data.wrench[i, 3:]
        load = T[6, :3, :3] @ data.load_point + T[6, :3, 3]
        reflector = data.reflectors[data.reflector[i]]
        point = T[reflector.link, :3, :3] @ reflector.position + T[reflector.link, :3, 3]
        simulated = np.zeros(3)
        for k in range(reflector.link):
            z, o = T[k, :3, 2], T[k, :3, 3]
            torque = z @ (couple + np.cross(load - o, force))
            simulated += torque / data.joint_stiffness[k] * np.cross(z, point - o)
        total += np.sum((data.displacement[i] - simulated) ** 2)
    assert document["baseline"]["holdout_rmse"] == pytest.approx(np.sqrt(total / (3 * len(data))), rel=1e-6)


def test_the_model_file_is_a_compliance_model(explained):
    _, out, _, _ = explained
    model = load_compliance_model(out / "model.yaml")
    q, wrench = np.zeros((1, 6)), np.array([[0.0, 200.0, 0.0, 0.0, 0.0, 0.0]])
    along = model.deflection(q, wrench, np.array([0, 0, 0.18]), np.ones((1, 6)))
    against = model.deflection(q, wrench, np.array([0, 0, 0.18]), -np.ones((1, 6)))
    assert (along - against)[0, 5] == pytest.approx(8e-5, rel=0.1)


def test_the_page_needs_nothing_from_outside(explained):
    _, out, _, _ = explained
    page = (out / "report.html").read_text()
    assert not re.search(r"(src|href)\s*=|url\(|@import|<script", page)
    first = re.search(r"<h1>(.*?)</h1>", page).group(1)
    assert first.startswith("Explained: backlash in joint 1 (")
    assert page.index("<h1>") < page.index("<svg")
    for title in (
        "Measured against simulated",
        "The pattern that gave it away",
        "Residual by joint",
        "Residual by load and time",
        "Candidates",
        "What cannot be told apart",
        "What to measure next",
    ):
        assert f"<h2>{title}</h2>" in page
    assert page.count("<svg") >= 12
    assert "nan" not in re.sub(r"<[^>]*>", " ", page).lower().split()
    assert not re.search(r'"(nan|inf|-inf)"', page)


def test_progress_is_shown_unless_quiet(explained, make_set, tmp_path, capsys):
    _, _, _, err = explained
    assert "noise floor" in err
    assert "models of 1" in err
    data = make_set(seed=42)
    code, out, err = run(capsys, "--data", data.path, "--out", tmp_path / "q", "--quiet")
    assert (code, err) == (0, "")
    assert out.startswith("consistent")


def test_every_verdict_exits_with_zero(make_set, tmp_path, capsys):
    dead = {"cause": "joint_dead_zone", "where": "joint 2", "parameters": {"torque": 60.0}}
    for seed, effects, verdict in ((43, [], "consistent"), (44, [dead], "unexplained")):
        data = make_set(effects, seed=seed, trials=100)
        code, out, _ = run(capsys, "--data", data.path, "--out", tmp_path / verdict)
        document = json.loads((tmp_path / verdict / "diagnosis.json").read_text())
        assert code == 0
        assert document["verdict"] == verdict
        assert document["causes"] == []
        assert out.startswith(verdict)
        assert (tmp_path / verdict / "report.html").read_text().count("<svg") >= 10


def test_sets_given_together_and_sets_to_check(make_set, tmp_path, capsys):
    one, two, three = (make_set([BACKLASH], seed=s) for s in (45, 46, 47))
    out = tmp_path / "out"
    code, _, _ = run(capsys, "--data", one.path, "--data", two.path, "--check", three.path, "--out", out)
    assert code == 0
    document = json.loads((out / "diagnosis.json").read_text())
    assert document["verdict"] == "explained"
    [check] = document["checks"]
    assert check["set"] == three.path.name
    assert check["rows"] == len(three)
    assert check["extended"]["rmse"] < 1.2 * document["noise_floor"] < check["baseline"]["rmse"]
    assert "Sets that were only predicted" in (out / "report.html").read_text()


def test_a_set_that_cannot_be_read_ends_with_two_and_one_line(make_set, tmp_path, capsys):
    data = make_set(seed=48)
    broken = tmp_path / "broken"
    shutil.copytree(data.path, broken)
    table = (broken / "trials.csv").read_text().splitlines()
    table[4] = table[4].replace(table[4].split(",")[5], "oops", 1)
    (broken / "trials.csv").write_text("\n".join(table) + "\n")
    for arguments in (
        ["--data", broken],
        ["--data", data.path, "--check", broken],
        ["--data", tmp_path / "nowhere"],
    ):
        code, out, err = run(capsys, *arguments, "--out", tmp_path / "none", "--quiet")
        assert code == 2
        assert out == ""
        assert err.count("\n") == 1
        assert re.search(r"(trials\.csv|set\.yaml): line \d+, column \S+", err)
        assert not (tmp_path / "none").exists()


def test_an_unknown_kind_of_set_is_refused(make_set, tmp_path, capsys):
    data = make_set(seed=49)
    text = (data.path / "set.yaml").read_text().replace("measurement-set/1", "soup/1")
    (data.path / "set.yaml").write_text(text)
    code, _, err = run(capsys, "--data", data.path, "--out", tmp_path / "none", "--quiet")
    assert code == 2
    assert "set.yaml: line 1" in err
    assert "doormill/measurement-set/1" in err
