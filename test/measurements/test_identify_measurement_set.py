"""Stiffness from measurement sets that the simulated truth generated."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.identification.joint_by_joint import identify_joint_by_joint
from doormill_ros.identification.weighted import fit_stiffness
from doormill_ros.measurements.errors import IdentifiabilityError
from doormill_ros.measurements.loading import displacement_per_compliance, loadings_of_set
from doormill_ros.measurements.sets.measurement_set import read_measurement_set

# Not the shipped stiffness, so that nothing can come out right because it went in.
TRUE = np.array([3.1e6, 1.7e6, 2.2e6, 2.6e5, 1.6e5, 6.1e4])


def loadings(kinematics, truth):
    return loadings_of_set(kinematics, read_measurement_set(truth.folder))


def test_without_noise_the_truth_comes_out(kinematics, make_set):
    """The truth chains finite rotations, so a linear model may differ by their squares (1e-3 of 1e-3 rad)."""
    data = loadings(kinematics, make_set(TRUE, noise=(1e-12, 1e-9, 1e-9)))
    fit = fit_stiffness(kinematics, data)
    assert fit.stiffness == pytest.approx(TRUE, rel=2e-3)
    steps = identify_joint_by_joint(kinematics, data, TRUE)
    assert {step.joint for step in steps} == {1, 2, 3, 4, 5, 6}


def test_prediction_agrees_with_the_truth(kinematics, make_set):
    data = loadings(kinematics, make_set(TRUE, noise=(1e-12, 1e-9, 1e-9)))
    predicted = displacement_per_compliance(kinematics, data) @ (1.0 / TRUE)
    assert np.abs(predicted - data.displacement).max() < 2e-3 * np.abs(data.displacement).max()


def test_deviations_are_as_large_as_the_standard_deviations_say(kinematics, make_set):
    """Pulls (error over standard deviation) of 6 joints in 12 sets have unit variance."""
    pulls, chi = [], []
    for seed in range(12):
        fit = fit_stiffness(kinematics, loadings(kinematics, make_set(TRUE, seed=seed)))
        pulls.append((fit.compliance - 1.0 / TRUE) / np.sqrt(np.diag(fit.compliance_covariance)))
        assert fit.degrees_of_freedom == 3 * 60 - 6
        chi.append(fit.chi_square / fit.degrees_of_freedom)
    # chi-square with 72 degrees: 5 sigma bounds of the mean square are 1 +- 5 sqrt(2/72).
    assert np.mean(np.square(pulls)) == pytest.approx(1.0, abs=5 * np.sqrt(2 / 72))
    # Each set has 174 degrees of freedom: 12 of them leave 5 sigma = 5 sqrt(2 / 2088).
    assert np.mean(chi) == pytest.approx(1.0, abs=5 * np.sqrt(2 / 2088))


def test_weights_of_the_wrench_matter(kinematics, make_set):
    """With a noisy sensor the reported deviation grows and still covers the truth."""
    quiet = fit_stiffness(kinematics, loadings(kinematics, make_set(TRUE, seed=3)))
    loud = fit_stiffness(kinematics, loadings(kinematics, make_set(TRUE, seed=3, noise=(8e-6, 8.0, 1.0))))
    assert np.all(loud.std > quiet.std)
    assert loud.chi_square / loud.degrees_of_freedom == pytest.approx(1.0, abs=5 * np.sqrt(2 / 174))
    assert loud.rounds > 1


@pytest.mark.parametrize("joint", range(6))
def test_formulas_are_exact_when_only_one_joint_gives_way(kinematics, make_set, joint):
    stiffness = np.full(6, 1e13)
    stiffness[joint] = TRUE[joint]
    data = loadings(kinematics, make_set(stiffness, noise=(1e-12, 1e-9, 1e-9)))
    first = identify_joint_by_joint(kinematics, data, stiffness)[0]
    assert first.joint == joint + 1
    assert first.isolation > 0.99
    assert first.stiffness == pytest.approx(TRUE[joint], rel=2e-3)


def test_known_joint_is_taken_off_the_next(kinematics, make_set):
    """Joints 1 and 6 soft: reflectors on link 1 tell joint 1, then the flange tells joint 6 beside it."""
    stiffness = np.full(6, 1e13)
    stiffness[[0, 5]] = TRUE[[0, 5]]
    data = loadings(kinematics, make_set(stiffness, n=100, noise=(1e-12, 1e-9, 1e-9)))
    steps = identify_joint_by_joint(kinematics, data, stiffness)
    assert (steps[0].joint, steps[1].joint, steps[1].subtracted) == (1, 6, (1,))
    assert steps[0].stiffness == pytest.approx(TRUE[0], rel=2e-3)
    assert steps[1].stiffness == pytest.approx(TRUE[5], rel=2e-3)
    # Without taking joint 1 off, its share of these trials would be left in.
    A = displacement_per_compliance(kinematics, data)[list(steps[1].trials)]
    left_in = np.linalg.norm(A[:, :, 0], axis=1).sum() / TRUE[0]
    assert left_in > 0.02 * np.linalg.norm(A[:, :, 5], axis=1).sum() / TRUE[5]


def test_first_step_is_as_wrong_as_its_isolation_allows(kinematics, make_set):
    """A share s of the displacement is the joint's own, so L lies between (2 s - 1) / s and 1 / s of it."""
    data = loadings(kinematics, make_set(TRUE, n=150))
    steps = identify_joint_by_joint(kinematics, data, TRUE)
    s = steps[0].isolation
    assert s > 0.8
    assert s * 0.98 < steps[0].stiffness / TRUE[steps[0].joint - 1] < s / (2 * s - 1) * 1.02
    # Each step subtracts exactly the joints that came before it.
    before: set[int] = set()
    for step in steps:
        assert set(step.subtracted) == before
        before |= {step.joint} if np.isfinite(step.stiffness) else set()
    # All joints at once do better than one after the other.
    weighted = fit_stiffness(kinematics, data)
    chained = np.array([step.stiffness / TRUE[step.joint - 1] for step in steps])
    assert np.abs(weighted.stiffness / TRUE - 1).max() < np.nanmax(np.abs(chained - 1))


def test_a_joint_that_no_trial_turns_stays_unknown(kinematics, make_set):
    """Reflectors on link 1 only: joints 2 to 6 move nothing that is seen."""
    data = loadings(kinematics, make_set(TRUE, noise=(1e-9, 1e-9, 1e-9)))
    data = data.pick(np.flatnonzero(data.reflector_link == 1))
    fit = fit_stiffness(kinematics, data)
    assert fit.identified.tolist() == [True, False, False, False, False, False]
    assert fit.degrees_of_freedom == 3 * len(data) - 1
    assert fit.stiffness[0] == pytest.approx(TRUE[0], rel=2e-3)
    steps = identify_joint_by_joint(kinematics, data, TRUE)
    assert [step.joint for step in steps if np.isfinite(step.stiffness)] == [1]


def test_joints_that_cannot_be_told_apart_are_not_named(kinematics, make_set):
    """One trial, however often repeated, tells three combinations of six compliances and no joint."""
    data = loadings(kinematics, make_set(TRUE, noise=(1e-9, 1e-9, 1e-9)))
    row = int(np.flatnonzero(data.reflector_link == 6)[0])
    for repeats in (1, 5):
        with pytest.raises(IdentifiabilityError):
            fit_stiffness(kinematics, data.pick(np.array([row] * repeats)))


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_few_trials_tell_few_joints_but_these_right(kinematics, make_set, n):
    """A joint that the trials do not tell must not be taken for rigid: that would falsify the others."""
    pulls = []
    for seed in range(25):
        try:
            fit = fit_stiffness(kinematics, loadings(kinematics, make_set(TRUE, seed=seed, n=n)))
        except IdentifiabilityError:
            continue
        told = fit.identified
        deviation = np.sqrt(np.diag(fit.compliance_covariance))
        pulls += list(((fit.compliance - 1.0 / TRUE) / deviation)[told])
    assert len(pulls) > 5
    assert np.abs(pulls).max() < 4.5
    assert np.mean(np.square(pulls)) < 1.6


def test_noise_alone_identifies_nothing(kinematics, make_set):
    data = loadings(kinematics, make_set(np.full(6, 1e15)))
    with pytest.raises(IdentifiabilityError, match="no joint"):
        fit_stiffness(kinematics, data)
