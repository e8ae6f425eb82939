"""Stiffness of pre-loaded joints and of joints in their backlash (section 3.3, table 4.3)."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doormill_ros.identification.weighted import fit_by_preload, fit_stiffness
from doormill_ros.measurements.loading import loadings_of_set
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.tools.identify import main

TRUE = np.array([3.1e6, 1.7e6, 2.2e6, 2.6e5, 1.6e5, 6.1e4])
# Crossed only at 3000 N m, so within the loads of the set the gap acts as a second spring in line.
GAP, CROSSING = 4.0e-4, 3000.0
BACKLASH = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": GAP, "crossing": CROSSING}}


def fits(kinematics, truth):
    measurements = read_measurement_set(truth.folder)
    data = loadings_of_set(kinematics, measurements)
    return fit_by_preload(kinematics, data, measurements.direction), fit_stiffness(kinematics, data)


def test_backlash_softens_the_joint_that_is_not_preloaded(kinematics, make_set):
    truth = make_set(TRUE, n=200, directed=True, effects=[BACKLASH], noise=(1e-9, 1e-6, 1e-6))
    split, together = fits(kinematics, truth)
    # The pre-loaded half is the spring itself; in the other half the gap's 4e-4 rad per 3000 N m adds to 1 / K.
    assert split.stiffness[0] == pytest.approx(TRUE[0], rel=0.01)
    assert split.stiffness[6] == pytest.approx(1 / (1 / TRUE[0] + GAP / CROSSING), rel=0.01)
    # Joints without backlash have one stiffness.
    assert split.stiffness[1:6] == pytest.approx(TRUE[1:], rel=0.01)
    assert split.stiffness[7:] == pytest.approx(TRUE[1:], rel=0.01)
    # One stiffness for both lies between.
    assert split.stiffness[6] < together.stiffness[0] < split.stiffness[0]


def test_without_backlash_both_halves_agree(kinematics, make_set):
    split, _ = fits(kinematics, make_set(TRUE, n=200, directed=True, seed=3))
    pulls = (split.compliance[:6] - split.compliance[6:]) / np.hypot(
        *np.split(np.sqrt(np.diag(split.compliance_covariance)), 2)
    )
    assert np.abs(pulls).max() < 4


def test_unknown_motion_counts_as_preloaded(kinematics, make_set):
    split, together = fits(kinematics, make_set(TRUE, seed=5))
    assert np.all(np.isnan(split.stiffness[6:]))
    assert split.stiffness[:6] == pytest.approx(together.stiffness, rel=1e-12)


def test_tool_prints_both(tmp_path, make_set, capsys):
    truth = make_set(TRUE, n=120, directed=True, effects=[BACKLASH])
    assert main(["--data", str(truth.folder), "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "not pre-loaded" in printed
    assert printed.count("has play") == printed.count("joint 1 has play") == 1
    document = json.loads((tmp_path / "out" / "identification.json").read_text())
    both = document["by_preload"]
    assert both["not_preloaded"]["stiffness"][0] < 0.9 * both["preloaded"]["stiffness"][0]


def test_table_4_3_of_the_thesis():
    """Joint 1 not pre-loaded over pre-loaded, from its four normalized figures: 0.63 to 0.75."""
    table = load_thesis_data().table_4_3
    ratios = [slack / tight for slack in table["not_preloaded"] for tight in table["preloaded"]]
    assert min(ratios) == pytest.approx(0.713 / 1.125)
    assert max(ratios) == pytest.approx(0.758 / 1.015)
