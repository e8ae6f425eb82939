"""What the gears of a measured robot do beyond springs: one recording judged by a model from another."""

import json
from pathlib import Path

import pytest

from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.robot_model.motion.model import load_motion_model
from doormill_ros.tools.diagnose import main
from support.source_tree import ROOT

KR300 = Path(__file__).parents[2] / "data" / "kr300"


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """What `diagnose --data test/data/kr300/A --check test/data/kr300/B --out` leaves, as the page has it."""
    folder = tmp_path_factory.mktemp("kr300")
    arguments = ["--data", str(KR300 / "A"), "--check", str(KR300 / "B"), "--out", str(folder), "--quiet"]
    assert main(arguments) == 0
    return folder


@pytest.fixture(scope="module")
def document(out):
    return json.loads((out / "diagnosis.json").read_text())


def test_encoders_are_late_together_by_three_milliseconds(document):
    first = document["causes"][0]
    assert (first["cause"], first["where"]) == ("time_skew", "link encoders")
    assert first["parameters"]["skew"]["value"] == pytest.approx(2.9e-3, abs=1e-4)
    assert first["holdout_rmse_without"] > 5.0 * document["extended"]["holdout_rmse"]
    assert (document["verdict"], document["unit"]) == ("partly_explained", "rad")


def test_joint_three_has_friction_and_no_joint_is_softer_than_published(document):
    named = {(one["cause"], one["where"]): one["parameters"] for one in document["causes"]}
    assert ("joint_friction", "joint 3") in named
    published = {"joint 1": 4577800.0, "joint 2": 7518900.0, "joint 3": 4099900.0}
    springs = {
        where: one["stiffness"]["value"] for (name, where), one in named.items() if "stiffness" in name
    }
    assert springs
    assert all(value > published[where] for where, value in springs.items())


@pytest.mark.parametrize(("where", "limit"), [("joint 1", 45e-6), ("joint 2", 75e-6), ("joint 3", 65e-6)])
def test_other_recording_is_predicted(document, where, limit):
    (check,) = document["checks"]
    one = check["by_joint"][where]
    assert one["extended"] < limit
    assert one["baseline"] > 400e-6
    assert one["extended_with_offset_alone"] < 75e-6
    assert document["by_joint"][where]["extended"] < 75e-6


def test_the_page_tells_what_was_left_before_and_after(document):
    (check,) = document["checks"]
    before, after = (
        [f"{1e6 * check['by_joint'][f'joint {k}'][name]:.0f}" for k in (1, 2, 3)]
        for name in ("baseline", "extended")
    )
    late = 1e3 * document["causes"][0]["parameters"]["skew"]["value"]
    page = " ".join((ROOT / "docs" / "diagnosis.md").read_text(encoding="utf-8").split())
    assert "miss recording B by {}, {} and {} urad in joints 1 to 3".format(*before) in page
    assert f"with link encoders {late:.1f} ms late, by " + "{}, {} and {}.".format(*after) in page


@pytest.mark.parametrize(("joint", "laws", "name"), [(1, False, "extended"), (2, True, "characterised")])
def test_model_file_predicts_what_the_document_says(out, document, joint, laws, name):
    """With its laws, which other joints may drive, where the joint has any."""
    model, motions = load_motion_model(out).of(joint), read_motion_set(KR300 / "B").motions
    assert bool(model.laws) == laws
    left = model.residual(next(one for one in motions if one.joint == joint), company=motions)
    assert left.std() == pytest.approx(document["checks"][0]["by_joint"][f"joint {joint}"][name], rel=1e-3)


def test_report_shows_it(out):
    page = (out / "report.html").read_text()
    for words in ("Every joint", "against the speed", "Waves over the angle", "Checked recordings by joint"):
        assert words in page
