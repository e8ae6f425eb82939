"""What moved the base while a series was recorded: a step, a warm-up or both, by their names and sizes."""

import json

import numpy as np
import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.kind import Poses

GEOMETRY = [(2, "a", 2e-4), (3, "alpha", 3e-4), (4, "d", -2e-4)]
SHIFT = np.array([3e-4, -2e-4, 1e-4])
NAMED = ("session_step", "thermal_drift")


@pytest.fixture
def diagnose(tmp_path, write_pose_sets, faults):
    def run(rows, seed, **case):
        folders = write_pose_sets(tmp_path / "data", faults(names=["alone"], **case), rows, seed)
        line = run_kind(Poses(), folders, [], tmp_path / "out")
        document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
        document["line"], document["page"] = line, (tmp_path / "out" / "report.html").read_text()
        return document, {one["cause"]: one for one in document["causes"] if one["cause"] in NAMED}

    return run


@pytest.mark.parametrize(("row", "seed"), [(12, 1), (20, 2), (28, 3), (20, 4)])
def test_a_step_in_forty_rows_is_no_drift(diagnose, row, seed):
    document, found = diagnose(40, seed, geometry=GEOMETRY, step=("alone", row, SHIFT))
    assert set(found) == {"session_step"}
    assert abs(found["session_step"]["parameters"]["row"]["value"] - row) <= 1
    links = {one["where"] for one in document["causes"] if one["cause"] == "link_geometry"}
    assert links == {"link 2", "link 3", "link 4"}


@pytest.mark.parametrize(("share", "rows"), [(0.08, 200), (0.15, 100), (0.25, 120)])
def test_a_warm_up_is_named_with_its_time_constant(diagnose, share, rows):
    constant = share * 10.0 * rows
    document, found = diagnose(rows, 5, geometry=GEOMETRY, warming=("alone", SHIFT, constant))
    assert document["verdict"] == "explained"
    assert set(found) == {"thermal_drift"}
    told = found["thermal_drift"]["parameters"]
    assert (
        abs(told["time_constant"]["value"] - constant) < 4.0 * told["time_constant"]["std"] < 2.0 * constant
    )
    whole = np.linalg.norm(SHIFT) * (1.0 - np.exp(-1.0 / share))
    assert np.linalg.norm(told["displacement"]["value"]) == pytest.approx(whole, rel=0.25)
    assert told["displacement"]["axes"] == "tracker"


def test_a_slow_warm_up_is_a_steady_drift(diagnose):
    document, found = diagnose(150, 6, warming=("alone", 10.0 * SHIFT, 3e4))
    assert (document["verdict"], set(found)) == ("explained", {"thermal_drift"})


def test_other_names_stand_beside_a_warm_up(diagnose):
    document, _ = diagnose(100, 7, periodic=[(4, 5, 5e-4, 0.3)], warming=("alone", 3.0 * SHIFT, 250.0))
    assert document["verdict"] == "explained"
    assert {(one["cause"], one["where"]) for one in document["causes"]} == {
        ("joint_periodic_error", "joint 4"),
        ("thermal_drift", "set"),
    }


def test_a_step_near_the_start_is_no_warm_up(diagnose):
    _, found = diagnose(200, 8, geometry=GEOMETRY, step=("alone", 20, SHIFT))
    assert set(found) <= {"session_step"}


def test_a_lone_series_has_one_name_wherever_it_is_told(diagnose):
    document, found = diagnose(50, 3, step=("alone", 25, SHIFT))
    beside = [one for cause in document["causes"] for one in cause["confusable_with"]]
    others = [*document["rejected"], *document["only_within_one_series"]]
    places = {one["where"] for one in (*document["causes"], *beside, *others)}
    assert {where for where in places if where.startswith("set")} == {"set"}
    assert found
    assert {one["cause"] for one in beside} & set(NAMED)


@pytest.mark.parametrize("stated", [True, False])
def test_a_verdict_by_an_assumed_noise_says_so(diagnose, stated):
    document, _ = diagnose(60, 9, stated=stated)
    assert ("assumed noise" not in document["line"]) == stated
    assert ("noise that was assumed" not in document["page"]) == stated
