"""The thesis' own loading tests, questioned: figures by hand, and tests held out from the fit."""

import numpy as np
import pytest

from doormill_ros.diagnosis.thesis_data import DECIDABLE, diagnose_thesis, read_preload_test
from doormill_ros.stiffness.identification.thesis_tests import load_thesis_data


@pytest.fixture(scope="module")
def data():
    return load_thesis_data()


@pytest.fixture(scope="module")
def found(data):
    return diagnose_thesis(data)


def test_gap_of_joint_1_by_hand(data):
    # A.8: Fy = -126.213 sin(a) - 122.843 cos(a), a = atan2(219.25, 226.66); arm 1.842 m, radius hypot(120, 480) mm.
    a = np.arctan2(219.25, 226.66)
    torque = abs(-126.2130 * np.sin(a) - 122.8430 * np.cos(a)) * 1.842
    reference = 65.7e-6 / np.hypot(0.120, 0.480)  # rad, the angle of the test that 1.0 stands for
    closed = reference / np.array([1.0, 1.015, 1.125])
    opened = reference / np.array([0.758, 0.713])
    gap = read_preload_test(data)
    assert gap.torque == pytest.approx(torque, rel=1e-6)
    assert gap.gap == pytest.approx(opened.mean() - closed.mean(), rel=1e-6)
    # Two means of a pooled scatter with three degrees of freedom.
    pooled = np.sqrt((closed.var() * 3 + opened.var() * 2) / 3 * (1 / 3 + 1 / 2))
    assert gap.gap_std == pytest.approx(pooled, rel=1e-6)
    assert gap.gap_ci95[0] == pytest.approx(gap.gap - 3.182 * pooled, rel=1e-3)
    assert gap.gap_ci95[0] > 0.0, "four readings are enough to say that there is something"


def test_both_readings_of_table_4_3_give_the_same_two_angles(data):
    """A gap in a stiff joint and friction in a soft one: one load cannot tell them apart."""
    gap = read_preload_test(data)
    opened = gap.torque / gap.stiffness_if_friction
    assert (gap.torque - gap.friction) / gap.stiffness_if_friction == pytest.approx(opened - gap.gap)


def test_the_simulation_of_test_3_is_joint_3_alone_and_lacks_joint_2(found):
    row = found.rows[2]
    assert row.own_joint == pytest.approx(row.simulated, rel=0.02)
    assert row.all_joints > 1.1 * row.measured > row.simulated
    assert "joint 2" in row.left_out


def test_the_cause_brings_tests_3_and_5_together_also_when_held_out(found):
    for joint in (3, 5):
        row = found.rows[joint - 1]
        thesis, springs = abs(row.simulated - row.measured), abs(row.all_joints - row.measured)
        assert abs(row.held_out - row.measured) < 0.75 * springs < thesis
    assert found.misfit[1] < 0.1 * found.misfit[0]


def test_what_the_printed_data_cannot_decide_is_said(found):
    names = {(c.name, c.where) for c in [found.cause, *found.confusable]}
    assert {("joint_stiffness", "joint 3"), ("joint_friction", "joint 3")} <= names
    assert "cannot be decided" in found.rows[3].left_out
    low, high = found.test_6_range
    assert low < found.rows[5].measured < high
    assert 6 not in DECIDABLE
    assert np.isnan(found.rows[5].held_out)
