"""Recordings of moving joints are read, and refused in one sentence where they cannot be used."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.motion.kind import Motions
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.sets.motion_set import read_motion_set
from support.motion_world import Recording, record

KR300 = Path(__file__).parents[1] / "data" / "kr300"


@pytest.fixture
def folder(tmp_path):
    return record(tmp_path / "set", Recording(seconds=3.0), seed=1)


def test_measured_recording_has_three_joints_at_250_hz():
    data = read_motion_set(KR300 / "A")
    assert data.joints == (1, 2, 3)
    assert (data.rate, len(data), data.noise) == (250.0, 2501, (None, None, None))
    second = data.motions[1]
    assert second.gear_ratio == pytest.approx(267.42857)
    assert second.stiffness == 7518900.0
    assert second.link[0] == pytest.approx(-2.57e-5)
    assert second.torque[0] == pytest.approx(-755.73)


def test_missing_samples_leave_gaps_in_time(tmp_path):
    data = read_motion_set(record(tmp_path / "gaps", Recording(seconds=3.0, dropped=0.05), seed=2))
    steps = np.diff(data.motions[0].time) * data.rate
    assert len(data) < 751
    assert steps.max() > 1.5
    assert np.allclose(steps, np.round(steps), atol=1e-6)


@pytest.mark.parametrize("other", [{"noise": (4.0e-5, 1.0e-6, 5.0)}, {"stated": False}])
def test_recordings_of_other_noise_are_checked_but_not_diagnosed_together(folder, tmp_path, other):
    first = read_motion_set(folder)
    second = read_motion_set(record(tmp_path / "other", Recording(seconds=3.0, **other), seed=2))
    Motions().check_together([first, first], [second])
    for sets in ([first, second], [second, first]):
        with pytest.raises(
            DataSetError, match=r"set\.yaml: line 1, column 1: noise is .*sets diagnosed"
        ) as raised:
            Motions().check_together(sets, [])
        assert raised.value.code == 504
        assert "\n" not in raised.value.message


def _times(folder, times, decimals):
    def change(lines):
        for i, time in enumerate(times, start=1):
            lines[i] = ",".join([f"{time:.{decimals}f}", *lines[i].split(",")[1:]])

    _rows(folder, change)


@pytest.mark.parametrize(
    ("stated", "true", "decimals"),
    [(250.0, 250.0 * 1.0001, 6), (250.0, 250.0 * 1.004, 6), (248.0, 1.0 / 0.004032, 6)]
    + [(rate, rate, 3) for rate in (400.0, 300.0, 240.0)],
)
@pytest.mark.parametrize("missing", [(), (40, 41, 300)])
def test_even_samples_are_read_whatever_clock_and_decimals_they_were_written_by(
    folder, stated, true, decimals, missing
):
    _edit(folder, lambda one: one.update(rate=stated))
    places = np.delete(np.arange(751 + len(missing)), list(missing))
    _times(folder, 5.0 + places / true, decimals)
    time = read_motion_set(folder).motions[0].time
    # Times rounded to a part of a step are those of the grid again, but for its fit.
    assert np.abs((time - time.mean()) * true - (places - places.mean())).max() < 0.02


@pytest.mark.parametrize(
    "shape",
    [
        lambda i: 0.3 * np.sin(0.7 * i),
        lambda i: np.where(i < 375, 0.0, 0.5),
        lambda i: 2.0 * (i / 750.0) ** 2,
        lambda i: np.where(i == 400, 0.2, 0.0),
        lambda i: np.random.default_rng(3).normal(0.0, 0.1, len(i)),
    ],
)
@pytest.mark.parametrize("decimals", [4, 6])
def test_uneven_samples_are_refused(folder, shape, decimals):
    places = np.arange(751.0)
    _times(folder, (places + shape(places)) / 250.0, decimals)
    with pytest.raises(
        DataSetError, match=r"beside the grid of 0\.00[34].* s that fits all times best"
    ) as raised:
        read_motion_set(folder)
    assert raised.value.code == 513


def test_lists_of_all_six_joints_are_taken_by_number(folder):
    _edit(folder, lambda one: one["model"].update(joint_stiffness=[1.0e6, 2.0e6, 3.0e6, 4e6, 5e6, 6e6]))
    assert [motion.stiffness for motion in read_motion_set(folder).motions] == [1e6, 2e6, 3e6]


def test_a_robot_of_seven_joints_is_read(folder):
    _edit(folder, lambda one: one.update(joints=[1, 2, 7]))
    _edit(folder, lambda one: one["model"].update(joint_stiffness=[1e6, 2e6, 3e6, 4e6, 5e6, 6e6, 7e6]))
    names = (folder / "samples.csv").read_text().splitlines()[0]
    seventh = names.replace("m3", "m7").replace("l3", "l7").replace("tau3", "tau7")
    _rows(folder, lambda lines: lines.__setitem__(0, seventh))
    with pytest.raises(DataSetError, match="column r7: the column is missing"):
        read_motion_set(folder)
    _rows(folder, lambda lines: lines.__setitem__(0, f"{lines[0]},r7"))
    _rows(folder, lambda lines: lines.__setitem__(slice(1, None), [f"{line},0.25" for line in lines[1:]]))
    data = read_motion_set(folder)
    assert [(motion.joint, motion.stiffness) for motion in data.motions] == [(1, 1e6), (2, 2e6), (7, 7e6)]
    assert data.commanded.shape == (len(data), 7)
    assert np.all(data.commanded[:, 6] == 0.25)


def _edit(folder, change):
    path = folder / "set.yaml"
    document = yaml.safe_load(path.read_text())
    change(document)
    path.write_text(yaml.safe_dump(document))


def _rows(folder, change):
    path = folder / "samples.csv"
    lines = path.read_text().splitlines()
    change(lines)
    path.write_text("\n".join(lines) + "\n")


def _cell(line, column, text):
    def change(lines):
        cells = lines[line].split(",")
        cells[lines[0].split(",").index(column)] = text
        lines[line] = ",".join(cells)

    return change


@pytest.mark.parametrize(
    ("change", "code", "told"),
    [
        (lambda f: _edit(f, lambda one: one.update(schema="doormill/motion-set/9")), 502, "doormill/motion-set/1"),
        (lambda f: _edit(f, lambda one: one.update(joints=[1, 2, 8])), 502, "ascending numbers from 1 to 7"),
        (lambda f: _edit(f, lambda one: one.update(joints=[])), 502, "ascending numbers from 1 to 7"),
        (lambda f: _edit(f, lambda one: one.update(Noise={})), 502, "Noise is read by nothing; write noise"),
        (lambda f: _edit(f, lambda one: one["model"].update(motor_inertias=[1.0])), 502, "write motor_inertia"),
        (lambda f: _edit(f, lambda one: one.update(rate=500.0)), 513, "a rate of 500 needs 0.002"),
        (lambda f: _edit(f, lambda one: one.update(rate=-1)), 502, "allowed is a positive number"),
        (lambda f: _edit(f, lambda one: one["model"].pop("joint_stiffness")), 502, "is missing"),
        (lambda f: _edit(f, lambda one: one["model"].update(gear_ratio=[1.0, 0.0, 1.0])), 502, "positive"),
        (lambda f: _edit(f, lambda one: one.update(noise=3)), 502, "needs link, motor and torque"),
        (lambda f: _rows(f, lambda lines: lines.__setitem__(0, lines[0].replace("l2", "x2"))), 503, "l2"),
        (lambda f: _rows(f, _cell(30, "l1", "nan")), 503, "line 31, column l1"),
        (lambda f: _rows(f, _cell(30, "tau3", "fast")), 503, "is no number"),
        (lambda f: _rows(f, _cell(30, "t", "0.1175")), 513, "beside the grid"),
        (lambda f: _rows(f, _cell(30, "t", "0.0")), 513, "times have to ascend"),
        (lambda f: _rows(f, lambda lines: lines.__delitem__(slice(100, None))), 513, "allowed are 200 or more"),
        (lambda f: _rows(f, lambda lines: lines.__delitem__(slice(100, 400))), 513, "are missing, allowed are 20"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused_in_one_sentence(folder, change, code, told):
    change(folder)
    with pytest.raises(DataSetError) as raised:
        read_motion_set(folder)
    assert raised.value.code == code
    assert told in raised.value.message
    assert "\n" not in raised.value.message


def changed(folder, column_of):
    """The samples of a folder with some columns as a function of their values says."""
    table = folder / "samples.csv"
    head, *rows = [line.split(",") for line in table.read_text().splitlines()]
    for row in rows:
        for at, name in enumerate(head):
            row[at] = column_of(name, row[at], rows[0][at])
    table.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    return folder


def test_a_recording_in_which_nothing_moves_is_refused(folder):
    still = changed(folder, lambda name, value, first: value if name == "t" else first)
    with pytest.raises(DataSetError, match="line 2, column m1: is as in all rows, as is every joint"):
        read_motion_set(still)


@pytest.mark.parametrize("kind", "ml")
def test_small_degrees_are_told_from_radians_by_what_was_commanded(tmp_path, kind):
    folder, by = record(tmp_path / "long", Recording(seconds=20.0), seed=1), {f"{kind}2": 180.0 / np.pi}
    changed(folder, lambda name, value, first: repr(by.get(name, 1.0) * float(value)))
    with pytest.raises(DataSetError, match=f"column {kind}2: changes by 5.\\.\\d where r2 .* write radians"):
        read_motion_set(folder)


@pytest.mark.parametrize("stated", [True, False])
def test_a_joint_that_stands_beside_others_that_move_is_at_the_noise(tmp_path, stated):
    folder = record(tmp_path / "set", Recording(seconds=6.0, stated=stated), seed=1)
    stands = ("m1", "l1", "tau1", "r1")
    data = read_motion_set(changed(folder, lambda name, value, first: first if name in stands else value))
    found = Motions().diagnose([data], lambda line: None)
    assert found.joints[0].problem.floor > 0.0
    assert not found.model.of(1).causes
