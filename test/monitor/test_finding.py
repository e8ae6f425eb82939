"""What is read from a diagnosis: each change of a cause, and which run it complains of."""

import pytest

from doormill_ros.monitor.complaint import complained_of
from doormill_ros.monitor.finding import finding_of

FORCE = {"cause": "process_force", "where": "tool"}


def changed(kind, run_id):
    return {"what": "process_force", "where": "tool", "kind": kind, "from_run": run_id}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([], [("always", "")]),
        ([changed("step", "r7")], [("step", "r7")]),
        ([changed("drift", "r1"), changed("step", "r7")], [("drift", "r1"), ("step", "r7")]),
    ],
)
def test_a_mill_that_wears_and_is_changed_is_told_with_both(changes, told):
    document = {
        "verdict": "explained",
        "causes": [FORCE],
        "changes": changes,
        "in_use": {"expected_error": 6e-4, "expected_error_extended": 3e-4, "difference": 1e-3},
        "noise_floor": 1e-5,
        "inspections": [{}] * 9,
        "remarks": [],
        "next_measurement": "",
    }
    found = finding_of(document, {"r1": "oak", "r7": "elm"})
    assert [(fault.course, fault.from_run) for fault in found.faults] == told


RUNS = ["1", "12", "door_1", "door_12", "a.b"]


@pytest.mark.parametrize(
    ("failure", "runs"),
    [
        ("/kept/question/door_12/points.csv: line 12, column deviation: is 'x'", ["door_12"]),
        ("/kept/question/door_1: holds no inspection.yaml", ["door_1"]),
        ("/kept/question/1/inspection.yaml, key noise: is -1", ["1"]),
        ("/kept/question/a.b", ["a.b"]),
        ("/kept/question/acb/points.csv: line 1", []),
        ("the diagnosis ended with 12", []),
    ],
)
def test_a_complaint_is_about_the_run_whose_file_it_names_and_no_other(failure, runs):
    assert complained_of(RUNS, failure) == runs
