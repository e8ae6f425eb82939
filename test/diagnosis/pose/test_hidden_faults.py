"""Invented robots with hidden faults: right names, sizes within their stated uncertainty, no false alarm."""

import json

import numpy as np
import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.kind import Poses

CASES = {
    "geometry": {"geometry": [(2, "a", 4e-4), (3, "alpha", 5e-4), (4, "d", -3e-4)]},
    "parallel axes": {"geometry": [(2, "beta", 3e-4)]},
    "sag of a small joint": {"sag": [(4, 6e-5)]},
    "gear": {"periodic": [(3, 2, 3e-4, 0.4), (3, 12, 2e-4, 1.0), (5, 100, 3e-4, 0.2)]},
    "backlash": {"backlash": [(2, 3e-4)]},
    "many": {
        "geometry": [(2, "a", 4e-4)],
        "sag": [(2, 9e-6), (3, 1.3e-5)],
        "periodic": [(1, 2, 3e-4, 0.3), (2, 15, 2e-4, 0.0)],
    },
}
SAG = {"sag": [(2, 9e-6)]}


def names_of(case):
    found = {("link_geometry", f"link {link}") for link, *_ in case.get("geometry", ())}
    found |= {("joint_sag", f"joint {joint}") for joint, _ in case.get("sag", ())}
    found |= {("joint_periodic_error", f"joint {joint}") for joint, *_ in case.get("periodic", ())}
    return found | {("joint_backlash", f"joint {joint}") for joint, _ in case.get("backlash", ())}


@pytest.fixture
def diagnose(tmp_path, write_pose_sets, faults):
    def run(case, rows=220, seed=5, check=(), **more):
        folders = write_pose_sets(tmp_path / "data", faults(**{**case, **more}), rows, seed)
        hold = [folder for folder in folders if folder.name in check]
        run_kind(Poses(), [f for f in folders if f not in hold], hold, tmp_path / "out")
        return json.loads((tmp_path / "out" / "diagnosis.json").read_text())

    return run


def assert_within(entry, truth, what):
    # Four standard deviations: some thirty numbers are checked here.
    assert abs(entry["value"] - truth) < 4.0 * entry["std"], what
    assert entry["std"] < 0.2 * abs(truth) + 2e-6, what


@pytest.mark.parametrize("name", CASES)
def test_the_right_names_and_sizes(diagnose, name):
    case = CASES[name]
    document = diagnose(case)
    assert document["verdict"] == "explained"
    found = {(c["cause"], c["where"]): c["parameters"] for c in document["causes"]}
    assert set(found) == names_of(case)
    for link, parameter, size in case.get("geometry", ()):
        assert_within(found["link_geometry", f"link {link}"][parameter], size, parameter)
    for joint, size in case.get("sag", ()):
        assert_within(found["joint_sag", f"joint {joint}"]["compliance"], size, joint)
    for joint, size in case.get("backlash", ()):
        assert_within(found["joint_backlash", f"joint {joint}"]["gap"], size, joint)
    for joint, order, size, _ in case.get("periodic", ()):
        assert_within(found["joint_periodic_error", f"joint {joint}"][f"order_{order}"], size, order)
    extended, floor = document["extended"], document["noise_floor"]
    assert floor == pytest.approx(np.sqrt(3.0) * 1.5e-5)
    assert extended["holdout_rmse"] < 1.1 * floor
    assert extended["series_out_rmse"] < 1.2 * floor
    low, high = document["gain"]["ci95"]
    assert low < document["gain"]["holdout_rmse_ratio"] < high < 0.9


@pytest.mark.parametrize(("turned", "side"), [(-3e-4, "short"), (3e-4, "beyond")])
def test_a_gap_is_a_size_and_its_side_is_told(diagnose, turned, side):
    """Play leaves the link behind the recorded angle; an encoder that lags shows the opposite."""
    document = diagnose({"backlash": [(2, turned)]}, rows=150)
    ((cause, gap),) = [(c["cause"], c["parameters"]["gap"]) for c in document["causes"]]
    assert cause == "joint_backlash"
    assert_within(gap, abs(turned), side)
    assert gap["side"] == side
    (line,) = [line for line in document["remarks"] if "gap" in line]
    assert line.startswith("Joint 2")
    assert f"half its gap {side}" in line


@pytest.mark.parametrize("seed", [1, 2])
def test_no_false_alarm(diagnose, seed):
    document = diagnose({}, seed=seed)
    assert document["verdict"] == "consistent"
    assert document["causes"] == []
    assert document["outliers"] == []


def test_gross_errors_are_listed_and_do_not_steer(diagnose):
    gross = [("first", 20), ("second", 100), ("second", 101), ("second", 210)]
    document = diagnose(SAG, gross=gross)
    assert document["outliers_by_set"] == {"first": [20], "second": [100, 101, 210]}
    found = {(c["cause"], c["where"]): c["parameters"] for c in document["causes"]}
    assert set(found) == {
        ("joint_sag", "joint 2"),
        ("gross_error", "set first"),
        ("gross_error", "set second"),
    }
    assert found["gross_error", "set second"]["rows"]["value"] == [100, 101, 210]
    assert_within(found["joint_sag", "joint 2"]["compliance"], 9e-6, "sag")


def test_gross_errors_alone_leave_the_model_consistent(diagnose):
    document = diagnose({}, gross=[("first", 20), ("second", 100)])
    assert (document["verdict"], document["causes"]) == ("consistent", [])
    assert document["outliers_by_set"] == {"first": [20], "second": [100]}


def test_a_step_is_dated_and_measured(diagnose):
    shift = np.array([2e-4, -1e-4, 1.5e-4])
    document = diagnose({}, step=("second", 180, shift))
    [cause] = document["causes"]
    assert (cause["cause"], cause["where"]) == ("session_step", "set second")
    assert abs(cause["parameters"]["row"]["value"] - 180) <= 1
    assert cause["parameters"]["time"]["value"] == pytest.approx(1800.0, abs=10.0)
    step = cause["parameters"]["step"]
    assert step["axes"] == "tracker"
    # The turn that goes with it pivots about the base: what the target shows is the step near the robot.
    assert np.linalg.norm(step["value"]) == pytest.approx(np.linalg.norm(shift), rel=0.15)
    assert np.dot(step["value"], shift) > 0.95 * np.linalg.norm(step["value"]) * np.linalg.norm(shift)


@pytest.mark.parametrize("size", [8e-5, 3e-4])
def test_what_is_not_in_the_library_is_not_named(diagnose, size):
    document = diagnose({}, strange=size)
    assert document["verdict"] == "unexplained"
    assert document["causes"] == []


def test_a_fault_of_one_series_is_not_laid_on_the_robot(tmp_path, write_pose_sets, faults):
    """A joint that sagged in one of three series only is no property of the robot."""
    sound = write_pose_sets(tmp_path / "a", faults(names=["one", "two"]), 200, 21)
    odd = write_pose_sets(tmp_path / "b", faults(names=["odd"], backlash=[(3, 3e-4)]), 200, 22)
    run_kind(Poses(), [*sound, *odd], [], tmp_path / "out")
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert ("joint_backlash", "joint 3") not in {(c["cause"], c["where"]) for c in document["causes"]}
    listed = {(c["cause"], c["where"]) for c in document["only_within_one_series"]}
    assert ("joint_backlash", "joint 3") in listed


def test_a_single_series_is_enough(diagnose):
    document = diagnose(SAG, names=["alone"])
    [cause] = document["causes"]
    assert (cause["cause"], cause["where"]) == ("joint_sag", "joint 2")
    assert any("single series" in line for line in document["remarks"])


class TestChecks:
    def test_a_checked_set_is_predicted_from_its_marked_rows(self, diagnose):
        names = ["first", "second", "new"]
        document = diagnose(CASES["many"], names=names, check=["new"])
        [check] = document["checks"]
        assert (check["set"], check["rows"], check["placement_rows"]) == ("new", 202, 18)
        assert check["baseline"]["rmse"] > 10.0 * check["extended"]["rmse"]
        assert check["extended"]["rmse"] < 1.25 * document["noise_floor"]
        assert check["extended"]["rotation_rmse"] < 1.25 * np.sqrt(3.0) * 6e-5

    def test_rows_to_predict_touch_nothing(self, tmp_path, write_pose_sets, faults):
        """Spoiling them changes their own figure and no other."""
        folders = write_pose_sets(tmp_path, faults(**SAG, names=["one", "new"]), 150, 6)
        table = folders[1] / "poses.csv"
        answers = []
        for spoil in (False, True):
            if spoil:
                lines = table.read_text().splitlines()
                for i in range(1, len(lines)):
                    cells = lines[i].split(",")
                    if cells[-1] == "0":
                        cells[9] = str(float(cells[9]) + 0.001 * (i % 3))
                    lines[i] = ",".join(cells)
                table.write_text("\n".join(lines) + "\n")
            run_kind(Poses(), folders[:1], folders[1:], tmp_path / "out")
            answers.append(json.loads((tmp_path / "out" / "diagnosis.json").read_text()))
        good, bad = answers
        assert good["causes"] == bad["causes"]
        assert good["extended"] == bad["extended"]
        assert bad["checks"][0]["extended"]["rmse"] > 5e-4 > 1e-4 > good["checks"][0]["extended"]["rmse"]
