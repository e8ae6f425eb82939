"""Shifts of gauged doors: what is hidden in their worlds has to be named, with its size and since which door."""

import itertools

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.core.kind import Progress
from doormill_ros.diagnosis.parts.doors.matching import cut_case
from doormill_ros.diagnosis.parts.effects.registry import PLACES_OF_LINKS
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.robot.description import load_robot
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import Hidden, draw_shift, inspected, judged

KIND = Inspections()
TURNS = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), 9))
GAP = {"gap": [1.2e-4, 0.0, 0.0, 0.0, 0.0, 0.0]}
QUIET: Progress = lambda line: None  # noqa: E731


def diagnosed(folder, world, doors):
    return KIND.diagnose(inspected(gauged_shift(folder, {"seed": 5, **world}, doors, 5)), QUIET)


def document(diagnosis, folder):
    return KIND.account(diagnosis, inspected(folder), [], QUIET).sections


def test_a_world_as_assumed_leaves_the_noise_of_the_gauge_at_every_point(tmp_path):
    doors = inspected(gauged_shift(tmp_path, {"seed": 1}, HINGE_DOORS[:2], 1))
    problem = KIND.problem(doors)
    left = (problem.measured - problem.case.springs()) / problem.noise
    assert len(left) > 300
    # 10 um of the gauge, 8 um of the localizations; nothing of the path, the envelope or the springs.
    assert 0.9 < np.sqrt(np.mean(left**2)) < 1.5
    assert np.abs(left).max() < 6.0
    found = KIND.diagnose(doors, QUIET)
    assert (found.verdict, found.findings) == ("consistent", ())


def test_a_gap_that_opens_and_a_force_that_is_off_are_told_apart_with_the_door(tmp_path):
    world = {"force": {"factor": 1.3}, "change": [{"from_door": 5, "robot": GAP}]}
    diagnosis = diagnosed(tmp_path, world, TURNS)
    hidden = (Hidden("process_force", "tool"), Hidden("joint_backlash", "joint 1", 5))
    found = judged(diagnosis, hidden)
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())
    values = {finding.cause.name: finding.values[0] for finding in diagnosis.findings}
    assert values["process_force"] == pytest.approx(1.3, abs=0.02)
    assert values["joint_backlash"] == pytest.approx(1.2e-4, rel=0.05)
    [change] = document(diagnosis, tmp_path)["changes"]
    assert (change["what"], change["where"], change["kind"]) == ("joint_backlash", "joint 1", "step")
    assert change["from_door"] == "door_005"
    assert change["from_door_ci95"][0] <= "door_005" <= change["from_door_ci95"][1]
    assert change["after"]["gap"] == pytest.approx(1.2e-4, rel=0.05)


def test_wear_is_a_drift_and_no_step(tmp_path):
    diagnosis = diagnosed(tmp_path, {"force": {"wear_per_door": 0.04}}, TURNS)
    [change] = document(diagnosis, tmp_path)["changes"]
    assert (change["what"], change["kind"]) == ("process_force", "drift")
    assert change["before"]["factor"] == pytest.approx(1.0, abs=0.03)
    assert change["after"]["factor"] == pytest.approx(1.0 + 8 * 0.04, abs=0.03)


def test_a_force_that_steps_while_the_mill_wears_is_one_cause_with_both_and_nothing_else(tmp_path):
    wear = {"wear_per_door": 0.04}
    world = {"force": wear, "change": [{"from_door": 5, "force": {"factor": 1.3, **wear}}]}
    diagnosis = diagnosed(tmp_path, world, TURNS)
    found = judged(diagnosis, (Hidden("process_force", "tool", 5),))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())
    drift, step = document(diagnosis, tmp_path)["changes"]
    assert [(one["what"], one["kind"]) for one in (drift, step)] == [
        ("process_force", "drift"),
        ("process_force", "step"),
    ]
    assert step["from_door"] == "door_005"
    # One slope stands for 0.04 a door before the step and 1.3 times that after it.
    assert drift["before"]["factor"] == pytest.approx(1.0, abs=0.05)
    assert step["before"]["factor"] == pytest.approx(1.0 + 5 * 0.04, abs=0.08)
    assert step["after"]["factor"] == pytest.approx(1.3 * (1.0 + 8 * 0.04), abs=0.05)


def test_another_recipe_is_no_change(tmp_path):
    doors = (HINGE_DOORS[0],) * 4 + (HINGE_DOORS[1],) * 4
    diagnosis = diagnosed(tmp_path, {"robot": GAP}, doors)
    assert diagnosis.problem.steps == ()
    assert document(diagnosis, tmp_path)["changes"] == []
    assert [finding.cause.key for finding in diagnosis.findings] == [("joint_backlash", "joint 1")]


def test_a_clamp_that_slips_is_found_with_its_door_and_the_camera_stands_beside_it(tmp_path):
    slip = [0.0, 1e-4, -1.5e-4]
    diagnosis = diagnosed(tmp_path, {"clamp": {"shift": slip, "from_door": 6}}, TURNS)
    found = judged(diagnosis, (Hidden("clamp_shift", "clamp", 6),))
    assert (found.missed, found.wrong, found.late) == ((), (), ())
    [finding] = diagnosis.findings
    either = {finding.cause.name, *(cause.name for cause in finding.confusable)}
    assert {"camera_shift", "clamp_shift"} <= either


def test_a_camera_that_moves_in_a_short_shift_is_found_although_each_recipe_comes_twice_only(tmp_path):
    moved = {"camera": {"moved": [0.0, 1.2e-4, 0.0], "from_door": 3}}
    diagnosis = diagnosed(tmp_path, moved, TURNS[:6])
    found = judged(diagnosis, (Hidden("camera_shift", "camera", 3),))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())


def test_a_clamp_that_slips_behind_a_force_is_found_when_the_doors_are_asked_again(tmp_path):
    world = {"force": {"factor": 1.32, "angle": 0.3}, "clamp": {"shift": [0.0, -1.9e-4, 0.0], "from_door": 4}}
    diagnosis = diagnosed(tmp_path, world, TURNS[:7])
    hidden = (
        Hidden("process_force", "tool"),
        Hidden("process_force_direction", "tool"),
        Hidden("clamp_shift", "clamp", 4),
    )
    found = judged(diagnosis, hidden)
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())


def test_points_of_one_moment_tell_the_load_of_that_moment(tmp_path):
    world = {"seed": 2, "force": {"factor": 1.5}}
    [one] = inspected(gauged_shift(tmp_path, world, HINGE_DOORS[:1], 2, (0.0, 0.0, 0.0)))
    points = one.door.points
    problem = KIND.problem([one])
    springs = cut_case(points, problem.robot, np.array(problem.tool)).springs()[:, :3]
    along = np.sum(springs * points.normal, axis=1)
    left = points.deviation - points.sent
    wall = points.wall
    assert np.polyfit(along[wall], left[wall], 1)[0] == pytest.approx(1.5, abs=0.02)
    assert np.std(left[wall] - 1.5 * along[wall]) == pytest.approx(1e-5, rel=0.25)


def test_charts_have_limits_with_their_origin_and_name_the_doors_beyond(tmp_path):
    diagnosis = diagnosed(tmp_path, {"change": [{"from_door": 5, "robot": GAP}]}, TURNS)
    charts = document(diagnosis, tmp_path)["charts"]
    assert charts["individuals"]["limits_origin"] == "mean moving range of door_000 to door_004, by recipe"
    assert set(charts["individuals"]["beyond"]) >= {f"door_00{k}" for k in range(5, 9)}
    assert max(charts["cusum"]["above"][:5]) < charts["cusum"]["alarm"] < charts["cusum"]["above"][-1]
    extended = [row["residual_extended"] for row in charts["doors"]]
    assert max(extended) < 2e-5
    assert {row["recipe"] for row in charts["capability"]} == {
        "thesis_190_0deg",
        "thesis_1350_0deg",
        "thesis_190_2deg",
    }
    assert all(row["cpk"] >= row["ppk"] > 0.0 for row in charts["capability"])
    assert charts["moving_range"]["values"][:3] == [None] * 3
    assert "door_005" in charts["moving_range"]["beyond"]


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(409, id="a clamp moved before the last two of five doors"),
        pytest.param(406, id="and a mill that wears"),
        pytest.param(486, id="a camera did"),
        pytest.param(524, id="a weight that lets the gap of a joint change its side"),
    ],
)
def test_a_drawn_shift_is_explained(tmp_path, seed):
    drawn = draw_shift(seed)
    diagnosis = KIND.diagnose(inspected(gauged_shift(tmp_path, drawn.world, drawn.doors, seed)), QUIET)
    found = judged(diagnosis, drawn.hidden)
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())


@pytest.mark.parametrize(("corner", "factor"), [(3e-4, 1.0), (5e-4, 1.3)])
def test_a_controller_that_lags_leaves_arcs_standing(tmp_path, corner, factor):
    world = {"controller": {"corner": corner}, "force": {"factor": factor}}
    diagnosis = diagnosed(tmp_path, world, TURNS[:6])
    hidden = [Hidden("path_lag", "controller"), *([Hidden("process_force", "tool")] if factor != 1.0 else [])]
    found = judged(diagnosis, tuple(hidden))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())
    (lag,) = [finding for finding in diagnosis.findings if finding.cause.name == "path_lag"]
    # Between samples half a millimetre apart the world's arcs are chords, which a mean takes for as much again.
    assert lag.values[0] == pytest.approx(corner, rel=0.15)


@pytest.mark.parametrize("lag", [0.02, 0.03])
def test_servo_loops_that_follow_late_are_told_by_the_speed(tmp_path, lag):
    diagnosis = diagnosed(tmp_path, {"controller": {"lag": lag}}, TURNS[:6])
    found = judged(diagnosis, (Hidden("path_lag", "controller"),))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())
    (cause,) = [finding.cause for finding in diagnosis.findings]
    theta = diagnosis.extended.theta[diagnosis.extended.part(cause)]
    assert np.sqrt(1e-4 * theta[0]) == pytest.approx(
        lag, rel=0.05
    )  # theta is the square of tens of milliseconds


def test_a_controller_that_was_set_anew_lags_from_that_door_on(tmp_path):
    world = {"change": [{"from_door": 4, "controller": {"corner": 5e-4}}]}
    diagnosis = diagnosed(tmp_path, world, TURNS[:8])
    found = judged(diagnosis, (Hidden("path_lag", "controller", 4),))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())


def test_what_hangs_on_the_arm_and_how_it_was_made_does_not_drift(tmp_path):
    problem = KIND.problem(inspected(gauged_shift(tmp_path, {"seed": 1}, TURNS[:6], 1))).changed_at((3,))
    drift = {one.name for one in problem.candidates() if one.course.drifts}
    steps = {one.name for one in problem.candidates() if one.course.steps}
    assert not drift & {"gravity_sag", "path_lag", "link_geometry", "joint_hardening"}
    assert {"process_force", "tool_radius", "clamp_shift"} <= drift
    assert {"gravity_sag", "path_lag", "process_force"} <= steps
    assert "joint_hardening" not in steps


ALPHA, THETA = 3, 0  #: columns of a Denavit-Hartenberg table
PLACED = (*HINGE_DOORS, "thesis_1350_2deg", "standard_door")


@pytest.mark.parametrize(("link", "column", "off"), [(3, ALPHA, 1.5e-4), (2, THETA, 1e-4)])
def test_a_link_that_is_off_is_told_by_doors_in_many_places(tmp_path, link, column, off):
    dh = load_robot(load_layout().robot).dh.copy()
    dh[link - 1, column] += off
    diagnosis = KIND.diagnose(inspected(gauged_shift(tmp_path, {"seed": 3}, PLACED, 3, dh=dh)), QUIET)
    assert diagnosis.verdict == "explained"
    [finding] = diagnosis.findings
    assert finding.cause.key == ("link_geometry", f"link {link}")
    angle = finding.values[3 if column == ALPHA else 2]
    assert angle == pytest.approx(off, rel=0.1)


def test_doors_in_few_places_tell_no_link(tmp_path):
    problem = KIND.problem(inspected(gauged_shift(tmp_path, {"seed": 3}, HINGE_DOORS, 3)))
    assert problem.places < PLACES_OF_LINKS
    assert not [one for one in problem.candidates() if one.name == "link_geometry"]
