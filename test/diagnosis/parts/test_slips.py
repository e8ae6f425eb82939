"""A gauge that slips at a point costs that point and nothing else."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.doors.recorded_cut import recorded_cut
from doormill_ros.diagnosis.parts.fitting.slips import slips, slips_beside
from doormill_ros.diagnosis.parts.kind import Inspections, inspected_door
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.inspections.inspection import inspections_in
from support.gauged_shift import HINGE_DOORS, gauged_shift

KIND = Inspections()
GAPS = {"gap": [2e-4, 1.5e-4, 1e-4, 0.0, 0.0, 0.0]}


@pytest.fixture(scope="module")
def door(tmp_path_factory):
    """A door milled with a force that is 30 % larger."""
    world = {"seed": 1, "force": {"factor": 1.3}}
    [inspection] = inspections_in(gauged_shift(tmp_path_factory.mktemp("door"), world, HINGE_DOORS[:1], 1))
    return inspection, recorded_cut(inspection)


def slipped(inspection, **by_row):
    deviation = inspection.deviation.copy()
    for row, size in by_row.items():
        deviation[int(row.removeprefix("row"))] += size
    return replace(inspection, deviation=deviation)


@pytest.mark.parametrize("size", [2e-3, 5e-3, -1e-2, 2e-2])
@pytest.mark.parametrize("row", [4, 99])
def test_what_is_wrong_is_named_as_if_the_gauge_had_not_slipped(door, row, size):
    inspection, cut = door
    one = inspected_door(slipped(inspection, **{f"row{row}": size}), cut)
    found = KIND.diagnose([one], lambda line: None)
    assert [finding.cause.key for finding in found.findings] == [("process_force", "tool")]
    assert found.findings[0].values[0] == pytest.approx(1.3, abs=0.02)
    assert one.door.largest < 1e-3
    account = KIND.account(found, [one], [], lambda line: None)
    assert account.sections["points"]["slips"] == 1
    [told] = [remark for remark in account.remarks if "slips of the gauge" in remark]
    assert told.endswith(f"door_000: {row + 1}.")


@pytest.mark.parametrize(("row", "size"), [(4, 4e-4), (40, 9e-4), (99, -6e-4)])
def test_a_slip_no_larger_than_what_mills_leave_is_told_by_what_was_found(door, row, size):
    inspection, cut = door
    one = inspected_door(slipped(inspection, **{f"row{row}": size}), cut)
    assert one.slipped == ()
    found = KIND.diagnose([one], lambda line: None)
    assert [finding.cause.key for finding in found.findings] == [("process_force", "tool")]
    account = KIND.account(found, [one], [], lambda line: None)
    assert account.sections["points"]["slips"] == 1
    [told] = [line for line in account.remarks if "slips" in line]
    assert told.endswith(f"door_000: {row + 1}.")


@pytest.mark.parametrize("every", [1, 3])
def test_gross_errors_are_told_by_their_rows_in_the_file_of_their_door(door, monkeypatch, every):
    """Of a shift with many points not every one is asked."""
    inspection, cut = door
    matched = inspected_door(inspection, cut).door.points.row
    monkeypatch.setattr("doormill_ros.diagnosis.parts.fitting.problem.ROWS", -(-len(matched) // every))
    wrong = tuple(int(row) for row in matched[::every][[20, 40]])
    moved = slipped(inspection, **{f"row{row}": 12.0 * inspection.noise for row in wrong})
    one = inspected_door(moved, cut)
    account = KIND.account(KIND.diagnose([one], lambda line: None), [one], [], lambda line: None)
    rows = account.sections["outliers_by_inspection"]["door_000"]
    assert {row + 1 for row in wrong} <= set(rows)
    assert len(rows) == len(account.outliers) < 6


def test_two_slips_side_by_side_are_two(door):
    inspection, _ = door
    assert np.flatnonzero(slips(slipped(inspection, row4=3e-3, row5=3e-3))).tolist() == [4, 5]


def test_a_door_that_is_wrong_at_one_point_in_five_is_refused_with_the_first_of_them(door):
    inspection, _ = door
    rows = {f"row{row}": 5e-3 for row in range(3, len(inspection), 5)}
    with pytest.raises(DataSetError, match=r"points.csv: line 5, column deviation: .* gauge the door again"):
        slips(slipped(inspection, **rows))


@pytest.mark.parametrize("size", [3e-3, 5e-3])
def test_where_points_are_few_only_what_no_door_may_be_off_is_a_slip(door, size):
    inspection, _ = door
    few = np.arange(0, len(inspection), 20)
    inspection = replace(
        inspection,
        feature=tuple(inspection.feature[row] for row in few),
        **{name: getattr(inspection, name)[few] for name in ("wall", "point", "normal", "deviation")},
    )
    assert np.flatnonzero(slips(slipped(inspection, row2=size))).tolist() == [2] * (size > 4e-3)


@pytest.mark.parametrize(
    "world",
    [
        {"robot": GAPS, "force": {"factor": 1.8}},
        {"clamp": {"shift": [0.0, 1.5e-3, -1.5e-3]}, "robot": GAPS},
        {"tool": {"mass": 25.0, "com": [0.0, 0.0, 0.2], "stiffness": 1e6}, "force": {"angle": 0.4}},
    ],
    ids=["gaps", "clamp", "tool"],
)
def test_nothing_that_a_mill_leaves_is_a_slip(tmp_path, world):
    doors = inspections_in(gauged_shift(tmp_path, {"seed": 3, **world}, HINGE_DOORS, 3))
    assert [bool(slips(one).any()) for one in doors] == [False] * 3
    assert min(np.abs(one.deviation).max() for one in doors) > 3e-4


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_slips_do_not_carry_doors_away_that_may_have_stood_anywhere(door, tmp_path, seed):
    world = {"seed": seed, "force": {"factor": 1.3}}
    rng, doors = np.random.default_rng(seed), []
    for inspection in inspections_in(gauged_shift(tmp_path, world, HINGE_DOORS, seed)):
        told = replace(inspection, datum="part")
        matched = inspected_door(told, recorded_cut(told)).door.points
        rows = rng.choice(matched.row[~matched.wall], 1), rng.choice(matched.row[matched.wall], 1)
        told = slipped(
            told, **{f"row{int(row[0])}": size for row, size in zip(rows, (-9e-4, 6e-4), strict=True)}
        )
        doors.append(inspected_door(told, recorded_cut(told)))
    found = KIND.diagnose(doors, lambda line: None)
    account = KIND.account(found, doors, [], lambda line: None)
    assert account.sections["points"]["slips"] == 2 * len(doors)
    assert [finding.cause.key for finding in found.findings] == [("process_force", "tool")]


@pytest.mark.parametrize(
    ("about", "apart", "peak", "slip"),
    [(0.0, 1.0, 90.0, True), (25.0, 1.0, 90.0, True), (40.0, 1.0, 90.0, False), (0.0, 38.0, 70.0, False)],
    ids=["quiet", "carried along", "a hollow", "neighbours apart"],
)
def test_a_slip_stands_out_from_the_points_around_it(door, about, apart, peak, slip):
    inspection, cut = door
    problem = KIND.problem([inspected_door(inspection, cut)])
    walls = np.flatnonzero(problem.points.wall & (problem.points.feature == problem.points.feature[0]))
    one = walls[len(walls) // 2]
    distance = np.linalg.norm(problem.points.point[walls] - problem.points.point[one], axis=1)
    white = np.zeros((len(problem), 1))
    white[walls, 0] = about
    white[walls[np.argsort(distance)[1:7]], 0] += apart * np.array([-0.5, -0.5, 0.0, 0.0, 0.5, 0.5])
    white[one] = peak
    prediction = SimpleNamespace(white=white)
    found = SimpleNamespace(
        problem=problem, kept=np.abs(white[:, 0]) < 10.0, best=SimpleNamespace(prediction=prediction)
    )
    assert np.flatnonzero(slips_beside(found)).tolist() == ([one] if slip else [])
