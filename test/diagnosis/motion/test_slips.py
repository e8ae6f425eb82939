"""Slips of a reading count in no figure, of the recording that was asked and of one that no fit has seen."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import check_set, named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.noise import no_slips
from doormill_ros.diagnosis.motion.skew import common_skew
from doormill_ros.measurements.sets.motion_set import read_motion_set
from support.motion_world import Recording, record
from support.source_tree import ROOT


def test_a_slip_changes_nothing_of_what_a_check_says(tmp_path):
    hidden = Recording(seconds=20.0).with_gear(2, stiffness=0.8)
    asked = read_motion_set(record(tmp_path / "asked", hidden, 1))
    other = read_motion_set(record(tmp_path / "other", hidden, 2))
    diagnosis = diagnose_motions([asked])
    slipped = []
    for motion in other.motions:
        link = motion.link.copy()
        link[[700, 2100]] += [0.1, -0.2]
        slipped.append(replace(motion, link=link))
    plain = check_set(diagnosis, other)["by_joint"]
    found = check_set(diagnosis, replace(other, motions=tuple(slipped)))["by_joint"]
    for joint, figures in plain.items():
        for name, value in figures.items():
            assert found[joint][name] == pytest.approx(value, rel=0.02), (joint, name)


def slipped_set(folder, hidden, seed):
    """A recording with slips of the link encoder of joint 2, and their samples."""
    table = record(folder, hidden, seed) / "samples.csv"
    head, *lines = table.read_text().splitlines()
    rows = np.array([line.split(",") for line in lines], dtype=float)
    slipped = np.arange(100, 2400, 150)
    rows[slipped, 5] += np.where(slipped % 4, 4e-4, -2e-3)
    np.savetxt(table, rows, fmt="%.9g", delimiter=",", header=head, comments="")
    return read_motion_set(folder), list(slipped)


@pytest.mark.parametrize("late", [0.0, 4e-3], ids=["quiet", "steep"])
def test_encoders_with_slips_are_told_as_without_these(tmp_path, late):
    hidden = Recording(noise=(3e-6, 1e-6, 5.0))
    for joint in (1, 2, 3):
        hidden = hidden.with_gear(joint, late=late)
    data, slipped = slipped_set(tmp_path / "set", hidden, 3)
    diagnosis = diagnose_motions([data])
    assert [list(np.flatnonzero(~one.problem.kept)) for one in diagnosis.joints] == [[], slipped, []]
    named = [(entry.cause, entry.where) for entry in named_causes(diagnosis)]
    assert named == ([("time_skew", "link encoders")] if late else [])
    assert diagnosis.verdict == ("explained" if late else "consistent")


@pytest.mark.parametrize("name", ["A", "B"])
def test_a_measured_joint_that_turns_after_a_rest_does_not_slip(name):
    motions = read_motion_set(ROOT / "test" / "data" / "kr300" / name).motions
    assert [motion.joint for motion in motions if not no_slips(motion).all()] == []


@pytest.mark.parametrize(
    ("values", "sure"), [((2.00e-3, 2.09e-3, 2.05e-3), False), ((2.0e-3, 2.0e-3, 2.001e-3), True)]
)
def test_joints_that_agree_by_less_than_they_say_make_the_common_skew_less_sure(values, sure):
    skews = {joint: (value, 1e-6) for joint, value in enumerate(values)}
    mean, std, agree = common_skew(skews, 3, lambda joint: (0.0, 1.0))
    assert agree == [0, 1, 2]
    assert mean == pytest.approx(np.mean(values), rel=1e-4)
    by_scatter = np.std(values, ddof=1) / np.sqrt(3.0)
    assert std == pytest.approx(max(by_scatter, 1e-6 / np.sqrt(3.0)), rel=1e-3)
    assert (std < 1e-6) == sure
