"""What a correction is worth: its spread against drawn springs and forces, its share against its purpose."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.worth import DeflectionSpread, worth_of
from doormill_ros.robot.description import load_robot

POSTURES = np.radians(
    [[-13.58, 69.54, 34.97, -14.01, -104.10, -93.48], [13.58, 6.89, -44.31, -21.68, 39.46, -72.94]]
)
WRENCH = np.array([12.0, 209.0, 29.0, 1.0, -3.0, 2.0])
STD = np.diag([20.0, 60.0, 10.0, 1.0, 4.0, 2.0])


@pytest.fixture(scope="module")
def worth():
    return worth_of(load_robot("irb6600_175_255"), bound=4e-5)


def moved(J, wrench, stiffness):
    """Displacement of the tool, one posture by its Jacobian, each joint by itself with its spring."""
    return sum(J[:3, k] * (J[:, k] @ wrench) / stiffness[k] for k in range(6))


@pytest.mark.parametrize("row", range(2))
def test_the_spread_is_that_of_drawn_springs_and_forces(worth, row):
    rng, q = np.random.default_rng(row), POSTURES[row]
    found = worth.spread(q[None], WRENCH[None], STD[None], load_layout().T_flange_tool[:3, 3])
    J = worth.kinematics.jacobian(q[None], load_layout().T_flange_tool[:3, 3])[0]
    small = 0.1  # first order: the tenth of every deviation
    drawn = [
        moved(
            J,
            WRENCH + small * rng.normal(size=6) @ STD,
            worth.stiffness * (1.0 + small * worth.relative * rng.normal(size=6)),
        )
        for _ in range(4000)
    ]
    off = np.array(drawn) - moved(J, WRENCH, worth.stiffness)
    expected = np.sqrt(np.mean(np.sum(off**2, axis=1))) / small
    assert found.total[0] == pytest.approx(expected, rel=0.05)


def test_no_other_share_of_a_noisy_figure_leaves_less(worth):
    """The mean square that is left of a true displacement by a share of a figure that scatters about it."""
    rng, true = np.random.default_rng(3), np.array([3e-4, -1e-4, 2e-4])
    s = 2e-4
    figures = true + s / np.sqrt(3.0) * rng.normal(size=(100_000, 3))
    deflection = np.zeros((1, 6))
    deflection[0, :3] = true
    spread = DeflectionSpread(np.zeros((1, 6)), np.array([s]), np.zeros(1))
    share = worth.share(deflection, spread, np.array([False]))[0]

    def left(rho):
        return np.mean(np.sum((true - rho * figures) ** 2, axis=1))

    assert share == pytest.approx(np.full(6, share[0]))
    assert left(share[0]) < left(0.0)
    assert left(share[0]) < left(1.0)
    assert all(left(share[0]) < left(share[0] + d) for d in (-0.1, 0.1))


def test_a_force_that_nobody_measured_moves_the_tool_by_the_bound_and_turns_it_never(worth):
    rng = np.random.default_rng(4)
    deflection = 1e-3 * rng.normal(size=(50, 6))
    spread = DeflectionSpread(np.zeros((50, 6)), np.full(50, 1e-5), np.zeros(50))
    share = worth.share(deflection, spread, np.ones(50, dtype=bool))
    corrected = share * deflection
    assert np.linalg.norm(corrected[:, :3], axis=1) == pytest.approx(np.full(50, 4e-5), rel=1e-6)
    assert not corrected[:, 3:].any()


def test_springs_of_unknown_spread_count_as_thirty_percent():
    robot = load_robot("irb6700_235_265")
    assert robot.stiffness_std is None
    assert worth_of(robot, 4e-5).relative == pytest.approx(np.full(6, 0.3))
