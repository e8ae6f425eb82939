import numpy as np
import pytest

from doormill_ros.robot.configuration import ConfData, configuration_index
from support.configuration import conf_data

RAD = np.pi / 180


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        # Table 4.6; quarters counted by hand, wrist in front of axis 1 and lower arm.
        ([-13.58, 69.54, 34.97, -14.01, -104.10, -93.48], ConfData(-1, -1, -2, 1)),
        ([13.58, 69.54, 34.97, 14.01, -104.10, -86.52], ConfData(0, 0, -1, 1)),
        ([-13.58, 6.89, -44.31, 21.68, 39.46, -107.06], ConfData(-1, 0, -2, 0)),
        ([13.58, 6.89, -44.31, -21.68, 39.46, -72.94], ConfData(0, -1, -1, 0)),
        ([0, 0, 0, 0, 0, 0], ConfData(0, 0, 0, 0)),
        ([90, 0, 0, 180, 10, -90], ConfData(1, 2, -1, 0)),
        ([0, 0, 0, 299, 10, -299], ConfData(0, 3, -4, 0)),
    ],
)
def test_quarters_and_branch(irb6600, angles, expected):
    assert conf_data(np.array(angles) * RAD, irb6600) == expected


def test_rounding_noise_below_a_border_counts_as_on_it(irb6600):
    q = np.array([-1e-15, 0, 0, np.pi / 2 - 1e-15, 0.5, np.pi - 1e-15])
    assert conf_data(q, irb6600) == ConfData(0, 1, 2, 0)


def test_branch_follows_where_the_wrist_centre_is(irb6600, table_2_1, frames_of):
    # Against plain geometry: seen along axis 2, with the arm turned back into the xz plane.
    q = np.random.default_rng(11).uniform(irb6600.lower, irb6600.upper, (2000, 6))
    index = configuration_index(irb6600, q)
    for row, cfx in zip(q, index, strict=True):
        in_plane = row.copy()
        in_plane[0] = 0.0
        frames = frames_of(table_2_1, in_plane)
        wrist, elbow = frames[4][:3, 3], frames[2][:3, 3]
        behind_axis_1 = wrist[0] < 0
        # Lower arm tilted by q2 from upright; its "front" is at right angles to it.
        front = np.array([np.cos(row[1]), 0, -np.sin(row[1])])
        behind_arm = (wrist - elbow) @ front < 0
        assert cfx == 4 * behind_axis_1 + 2 * behind_arm + (row[4] < 0)


def test_all_eight_branches_occur(irb6600):
    q = np.random.default_rng(12).uniform(irb6600.lower, irb6600.upper, (5000, 6))
    assert set(configuration_index(irb6600, q)) == set(range(8))
