"""What every door shows alike has no name, and what changes beside it is named all the same."""

import itertools

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.discrepancy import ArmDiscrepancy, ForceDiscrepancy, WallDiscrepancy
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.measurements.inspections.inspection import inspections_in
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import Hidden, inspected, judged

KIND = Inspections()
STEP, COUNT = 4, 8
OFF = {"robot": {"pose_error": {"seed": 5, "size": 2e-4}}}  #: an arm that nobody calibrated
TURNING = {"force": {"law": "engagement"}}  #: a force that turns with the feed


def quiet(line):
    pass


def asked(folder, world, doors, seed=2):
    sets = inspected(gauged_shift(folder, {"seed": seed, **world}, doors, seed))
    diagnosis = KIND.diagnose(sets, quiet)
    return diagnosis, sets


def turns(*doors):
    return tuple(itertools.islice(itertools.cycle(doors), COUNT))


CLAMP = ({"clamp": {"shift": [0.0, 2e-4, -1e-4], "from_door": STEP}}, Hidden("clamp_shift", "clamp", STEP))
FORCE = (
    {"change": [{"from_door": STEP, "force": {"factor": 1.4}}]},
    Hidden("process_force", "tool", STEP),
)


@pytest.mark.parametrize("change", [CLAMP, FORCE], ids=["clamp", "force"])
def test_changes_are_named_on_an_arm_that_is_off_everywhere(tmp_path, change):
    world, hidden = change
    diagnosis, _ = asked(tmp_path, OFF | world, turns(*HINGE_DOORS))
    assert [type(one) for one in diagnosis.problem.discrepancies] == [ArmDiscrepancy]
    found = judged(diagnosis, (hidden,))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("partly_explained", (), (), ())
    assert diagnosis.question.holdout_rmse(diagnosis.extended, diagnosis.kept) < 1.1e-5


# Beside a scatter that acts on the nominal springs, soft as they are, these doors showed a spring that changed.
@pytest.mark.parametrize("seed", [3, 4, 6])
def test_a_soft_spring_is_named_beside_forces_that_scatter_from_door_to_door(tmp_path, seed):
    world = {"force": {"scatter": 0.12}, "robot": {"stiffness_factor": [0.6, 1.0, 1.0, 1.0, 1.0, 1.0]}}
    diagnosis, _ = asked(tmp_path, world, turns(*HINGE_DOORS), seed)
    assert [type(one) for one in diagnosis.problem.discrepancies] == [ForceDiscrepancy]
    found = judged(diagnosis, (Hidden("joint_stiffness", "joint 1"),))
    assert (found.verdict, found.missed, found.wrong) == ("partly_explained", (), ())
    [finding] = diagnosis.findings
    assert finding.values[0] == pytest.approx(
        0.6 * diagnosis.problem.robot.stiffness[0], abs=5.0 * finding.std[0]
    )


def test_a_slip_of_the_clamp_is_named_beside_forces_that_turn_with_the_feed(tmp_path):
    world, hidden = CLAMP
    diagnosis, _ = asked(tmp_path, TURNING | world, turns(HINGE_DOORS[1]))
    assert [type(one) for one in diagnosis.problem.discrepancies] == [WallDiscrepancy]
    found = judged(diagnosis, (hidden,))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("partly_explained", (), (), ())


@pytest.mark.parametrize("world", [OFF, TURNING], ids=["arm", "force"])
def test_where_nothing_changes_nothing_is_named(tmp_path, world):
    diagnosis, sets = asked(tmp_path, world, turns(HINGE_DOORS[1]))
    assert (diagnosis.verdict, diagnosis.findings) == ("unexplained", ())
    account = KIND.account(diagnosis, sets, (), quiet)
    (law,) = account.sections["unnamed"]
    deviations = np.concatenate([one.deviation for one in inspections_in(tmp_path)])
    told = float(law["law"].split("by ")[-1].split(" um")[0]) * 1e-6
    assert 0.2 * np.std(deviations) < told < 1.5 * np.std(deviations)
    left = account.sections["characterised"]
    assert left["ci95"][0] <= left["holdout_rmse"] <= left["ci95"][1]
    assert left["holdout_rmse"] < 1.3e-5 < 0.3 * law["holdout_rmse_without"]
    assert any(law["law"] in remark for remark in account.remarks)
    assert account.baseline["holdout_rmse"] == pytest.approx(law["holdout_rmse_without"])


def test_a_cause_that_was_always_there_is_not_told_from_the_walls_of_a_recipe(tmp_path):
    world = TURNING | {"tool": {"stiffness": 1.5e6}}
    diagnosis, _ = asked(tmp_path, world, turns(HINGE_DOORS[1]))
    assert (diagnosis.verdict, diagnosis.findings) == ("unexplained", ())


def test_recipes_that_come_once_have_no_walls_of_their_own(tmp_path):
    diagnosis, _ = asked(tmp_path, TURNING, (*HINGE_DOORS, "thesis_1350_2deg"))
    assert diagnosis.problem.discrepancies == ()
    assert (diagnosis.verdict, diagnosis.findings) == ("unexplained", ())


def test_a_door_far_beside_its_place_is_matched_where_it_was_milled(tmp_path):
    world = {"clamp": {"shift": [0.0, 7e-4, -8e-4], "from_door": 0}}
    problem = KIND.problem(inspected(gauged_shift(tmp_path, {"seed": 1, **world}, ("standard_door",), 1)))
    left = problem.measured - problem.case.springs()
    design = np.column_stack([problem.points.normal, problem.points.wall])
    place = np.column_stack([problem.door_places.known * problem.noise[:, None], design])
    left = left - place @ np.linalg.lstsq(place, left, rcond=1e-9)[0]
    names = sorted(set(problem.points.feature.tolist()))
    assert "handle_hole" in names
    for name in names:
        rows = problem.points.feature == name
        assert np.sqrt(np.mean(left[rows] ** 2)) < 1.3e-5, name
