"""From a hidden law to diagnosis.json, report and model, on simulated labs that share no code with the dictionary."""

import json

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.loading.laws import MEAN_PART, with_laws
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.sets.join_sets import join_sets
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.tools.diagnose import main
from support.law_worlds.world import draw


def told(tmp_path, seed):
    """Truth, diagnosis.json, report and model.yaml of one world."""
    world = draw(seed)
    world.write(tmp_path / "set")
    world.write_unseen(tmp_path / "unseen")
    out = tmp_path / "out"
    arguments = ["--data", str(tmp_path / "set"), "--check", str(tmp_path / "unseen"), "--out", str(out)]
    assert main(arguments) == 0
    document = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    model = yaml.safe_load((out / "model.yaml").read_text(encoding="utf-8"))
    return world.truth, document, (out / "report.html").read_text(encoding="utf-8"), model, out


def test_a_law_of_a_joint_is_placed_told_and_predicts_unseen_postures(tmp_path):
    truth, document, page, model, out = told(tmp_path, 0)
    assert truth["where"].startswith("joint")
    assert truth["named"] is None
    assert document["verdict"] == "unexplained"
    assert document["causes"] == []
    (law,) = document["unnamed"]
    assert (law["where"], law["driver"]) == (truth["where"], truth["driver"])
    assert "%" in law["law"]
    assert law["test"] in page
    assert "A law without a name" in page
    # `extended` has the named causes only: none.
    assert document["extended"]["holdout_rmse"] == document["baseline"]["holdout_rmse"]
    (check,) = document["checks"]
    floor = truth["noise"]["floor_unseen"]
    assert check["extended"]["rmse"] > 1.7 * floor
    assert check["characterised"]["rmse"] < 1.1 * floor
    low, high = document["characterised"]["ci95"]
    assert low < document["characterised"]["holdout_rmse"] < high < law["holdout_rmse_without"]
    assert [entry["where"] for entry in model["laws"]] == [truth["where"]]
    assert len(load_compliance_model(out).laws) == 1


def test_a_law_of_the_sensor_moves_no_tool(tmp_path):
    truth, document, _, _, out = told(tmp_path, 2)
    assert truth["where"] == "sensor"
    assert {law["where"] for law in document["unnamed"]} == {"sensor"}
    (check,) = document["checks"]
    assert check["characterised"]["rmse"] < 1.1 * truth["noise"]["floor_unseen"]
    assert "path_shift" not in document
    assert not any(law.cause.of_robot for law in load_compliance_model(out).laws)


@pytest.mark.parametrize(
    ("seed", "law"),
    [
        (78, "rocking_base"),  # over one edge of the foot, once that lifts
        (77, "opening_seat"),  # the tool's, one way
        (87, "coupling"),  # beside friction that holds a part of the load
        (539, "worn_sector"),  # beside play; all laws that are found predict no other posture, two of them do
    ],
)
def test_what_opens_or_holds_predicts_unseen_postures(tmp_path, seed, law):
    truth, document, _, _, _ = told(tmp_path, seed)
    assert truth["law"] == law
    assert (truth["where"], truth["driver"]) in {(one["where"], one["driver"]) for one in document["unnamed"]}
    (check,) = document["checks"]
    assert check["characterised"]["rmse"] < 2.0 * truth["noise"]["floor_unseen"]


@pytest.mark.parametrize("effects", [[], "named"])
def test_where_nothing_remains_nothing_is_said(make_set, effects, monkeypatch):
    """Neither of noise nor beside a cause that explains everything; nor is anything searched."""
    if effects:
        effects = [
            {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 1e-4, "crossing": 20.0}}
        ]
    diagnosis = diagnose_problem(LoadingProblem(make_set(effects, seed=3)))
    assert diagnosis.verdict == ("explained" if effects else "consistent")
    monkeypatch.setattr("doormill_ros.diagnosis.loading.laws.LawSearch", None)
    assert with_laws(diagnosis).characterised is None


@pytest.mark.parametrize(
    ("seed", "where", "name"),
    [
        (1029, "link 4", "link_bending at link 4"),
        # Its own bearing tilts where a link gives way.
        (769, "link 2", "joint_cross_compliance at joint 2"),
        (871, "joint 3", "joint_stiffness at joint 3"),
    ],
)
def test_a_cause_at_the_place_of_a_law_may_be_its_mean_and_is_not_named(tmp_path, seed, where, name):
    world = draw(seed)
    assert (world.truth["where"], world.truth["named"]) == (where, None)
    world.write(tmp_path / "set")
    before = diagnose_problem(LoadingProblem(join_sets([read_measurement_set(tmp_path / "set")])))
    assert name in {repr(finding.cause) for finding in before.findings}
    after = with_laws(before)
    assert (after.verdict, after.findings) == ("unexplained", ())
    assert name in {repr(cause) for cause, why in after.examination.refused if why == MEAN_PART}
    assert where in {law.where for law in after.characterised.laws}


def test_a_cause_beside_a_law_is_told_with_its_numbers_beside_it(tmp_path):
    """A spring of another stiffness, and another joint's that gives way to one side only."""
    world = draw(16)
    world.write(tmp_path / "set")
    before = diagnose_problem(LoadingProblem(join_sets([read_measurement_set(tmp_path / "set")])))
    after = with_laws(before)
    (finding,) = after.findings
    assert {"cause": finding.cause.name, "where": finding.cause.where}.items() <= world.truth["named"].items()
    assert np.array_equal(finding.values, after.characterised.weights(finding.cause))
    assert not np.array_equal(finding.values, before.findings[0].values)
    true = world.truth["named"]["parameters"]["stiffness"]
    assert abs(finding.values[0] - true) < 4.0 * finding.std[0] < 0.02 * true
    # What would do in its place is said by the search over names.
    assert [other for other, _ in finding.rivals] == [other for other, _ in before.findings[0].rivals]
