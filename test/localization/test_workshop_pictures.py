"""Workshop pictures: accurate, not refused without cause, never wrong with confidence."""

import numpy as np

from doormill_ros.units import DEG, MM


def test_errors_are_below_two_hundredths(looked):
    errors = np.array([x.error for x in looked if x.item.acceptable and x.found])
    assert len(errors) > 55
    assert np.percentile(np.hypot(errors[:, 0], errors[:, 1]), 95) < 0.02 * MM
    assert np.percentile(np.abs(errors[:, 2]), 95) < 0.02 * DEG


def test_acceptable_pictures_are_accepted(looked):
    accepted = [x.found is not None for x in looked if x.item.acceptable]
    assert np.mean(accepted) >= 0.98, [str(x.refused) for x in looked if x.item.acceptable and x.refused]


def test_no_pose_is_confidently_wrong(looked):
    poses = [x for x in looked if x.found]
    assert len(poses) > 55
    for x in poses:
        assert np.hypot(*x.error[:2]) < 0.1 * MM, x.item.label
        assert abs(x.error[2]) < 0.1 * DEG, x.item.label
        assert x.error @ np.linalg.solve(x.found.covariance, x.error) < 36.0, x.item.label


def test_spoilt_pictures_are_refused_for_what_spoils_them(looked):
    reasons = {}
    for x in looked:
        if x.refused:
            reasons.setdefault(x.item.label, set()).add(type(x.refused).__name__)
    assert reasons["defocused"] == {"Blurred"}
    assert reasons["glare"] == {"OverExposed"}
    assert reasons["dark"] == {"UnderExposed"}
    assert reasons["outside"] == {"OutOfRange"}
    assert reasons["covered"] <= {"NoEdge", "WrongEdge", "TooFewInliers"}
    assert reasons["chipped away"] <= {"WrongEdge", "TooFewInliers"}
