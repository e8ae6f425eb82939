"""Slips of a reading count in no figure, of the recording that was asked and of one that no fit has seen."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import check_set
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.skew import common_skew
from doormill_ros.measurements.motion_set import read_motion_set
from support.motion_world import Recording, record


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
