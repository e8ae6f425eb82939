"""From the judge to message, report and summary."""

import json
from pathlib import Path

import numpy as np
import pytest
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.nodes.convert.executed import verdict_message
from doormill_ros.nodes.one_process.cell_driver import _touched
from doormill_ros.report.run_record import read_run
from doormill_ros.report.run_report import render_report
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import BodyTouched, WoodOutsideFeatures
from doormill_ros.simulation.judge.verdict import Touch, Verdict, WoodGone

ELBOW = Touch(
    body="elbow",
    obstacle="door",
    motion=5,
    feature="hinge_1",
    time=14.5,
    depth=0.164,
    place=np.array([-0.2, 0.05, 1.35]),
    samples=frozenset({3, 4, 5}),
)
WOOD = WoodGone(
    motion=1,
    feature="",
    time=10.1,
    volume=2.1479e-4,
    depth=0.040,
    place=np.array([0.04, 0.003, 1.778]),
    samples=frozenset({1, 2, 3}),
)
CLEAN, BOTH, WOOD_ONLY = Verdict(100), Verdict(100, (ELBOW,), (WOOD,)), Verdict(100, (), (WOOD,))


def message_of(verdict, run_id="run"):
    return verdict_message(verdict, Header(frame_id="door"), DoorPlacement(run_id=run_id, door_id="door"))


def test_the_sentence_names_body_obstacle_motion_and_depth():
    assert CLEAN.error is None
    assert isinstance(WOOD_ONLY.error, WoodOutsideFeatures)
    assert isinstance(BOTH.error, BodyTouched)
    assert BOTH.sentence == (
        "elbow touched the door in motion 5 of hinge_1 after 14.50 s, 164.0 mm deep at x -200, y 50, z 1350 mm of the "
        "door; the mill took 214790 mm^3 of wood outside the features in motion 1 after 10.10 s, 40.0 mm deep at x 40, "
        "y 3, z 1778 mm of the door; allowed is to touch nothing but the wood to be cut, something else was touched in "
        "5 of 100 samples: plan another way, or mill the door in another place"
    )


def test_the_message_holds_every_touch():
    message = message_of(BOTH)
    assert (message.success, message.error_code, message.judged, message.touched) == (False, 854, 100, 5)
    assert message.volume == pytest.approx(2.1479e-4)
    assert [(t.body, t.obstacle, t.motion, t.samples) for t in message.touches] == [
        ("elbow", "door", 5, 3),
        ("mill", "door", 1, 3),
    ]
    assert [t.volume for t in message.touches] == [0.0, 2.1479e-4]
    clean = message_of(CLEAN)
    assert (clean.success, clean.error_code, clean.touched, clean.touches) == (True, 0, 0, [])
    assert clean.message == "nothing was touched but the wood to be cut in 100 samples"


def test_the_summary_holds_it_under_a_key_of_its_own(tmp_path: Path):
    path = tmp_path / "summary.json"
    RunSummary("door", True, "milled", touched=_touched(message_of(BOTH))).write(path)
    document = json.loads(path.read_text())
    assert document["schema"] == "doormill/run/1"
    touched = document["touched"]
    assert (touched["known"], touched["judged"], touched["samples"]) == (True, 100, 5)
    assert touched["bodies"][0] == {
        "body": "elbow",
        "obstacle": "door",
        "motion": 5,
        "feature": "hinge_1",
        "time": 14.5,
        "depth": 0.164,
        "volume": 0.0,
        "samples": 3,
        "place": [-0.2, 0.05, 1.35],
    }


@pytest.mark.parametrize("verdict", [CLEAN, BOTH], ids=["clean", "touched"])
def test_the_report_says_it(verdict):
    record = read_run(resource("bags/standard_door"))
    run_id = record.get("run/result").run_id
    record.latest["simulation/verdict"] = message_of(verdict, run_id)
    page = render_report(record)
    assert verdict.sentence in page
    assert ("touched what it must not" in page) == (verdict is BOTH)
    assert ("Error code 854." in page) == (verdict is BOTH)
