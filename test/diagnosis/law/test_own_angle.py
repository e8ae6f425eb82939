"""Laws of a moving joint that follow its own angle: worn or misread in one place, and a wave beside a straight line."""

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.law.linear import LinearProblem, established
from doormill_ros.diagnosis.law.remainder import searched_once
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.robot_model.motion.law.dictionary import dictionary
from doormill_ros.robot_model.motion.law.ride import ride_of
from support.motion_laws.world import draw

SIGMA = 1e-5  # rad


@pytest.fixture(scope="module")
def ride(tmp_path_factory: pytest.TempPathFactory):
    """How joint 3 of an arm was moved; what its encoders read is put in its place."""
    folder: Path = draw(1).write(tmp_path_factory.mktemp("arm") / "set")
    motions = read_motion_set(folder).motions
    return ride_of(next(one for one in motions if one.joint == 3), motions)


def found(ride, difference):
    """Terms of laws for a difference of the encoders, shape (n,) [rad]."""
    n = len(ride)
    noise = SIGMA * np.random.default_rng(3).normal(size=n)
    blocks = np.arange(n) * 20 // n
    problem = LinearProblem((difference + noise)[:, None], np.array([SIGMA]), (ride,), blocks, SIGMA)
    base = established(np.ones((n, 1, 1)), problem.sigma, np.array([np.inf]))
    return searched_once(problem, base, dictionary((ride,))).laws


@pytest.mark.parametrize("acts_on", ["spring", "joint angle"])
def test_what_is_off_in_one_place_is_one_sector(ride, acts_on):
    angle = ride.own.motor
    middle = float(np.quantile(angle, 0.7))
    bump = np.exp(-(((angle - middle) / 0.1) ** 2))
    # So small that the noise hides in which of several like shapes it fades away.
    share = 3.0 * SIGMA / np.abs(ride.spring).max() * ride.spring if acts_on == "spring" else 3.0 * SIGMA
    (term,) = found(ride, share * bump)
    assert (term.acts_on, term.driver, term.shape) == (acts_on, "own angle", "sector")
    assert term.numbers[1] == pytest.approx(middle, abs=0.05)


def test_beside_a_straight_line_of_the_same_angle_only_the_wave_goes_on(ride):
    angle = ride.own.motor
    terms = found(ride, 3e-4 * angle + 8e-5 * np.sin(15.0 * angle))
    assert {term.shape: term.seen.ends for term in terms} == {"slope": True, "waves": False}
