import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.robot.denavit_hartenberg import table_of_chain
from doormill_ros.robot.errors import RobotDescriptionError
from doormill_ros.robot.urdf import Chain


def chain_of(table, frames_of):
    """The axes of a table in its zero position, as a URDF would state them."""
    frames = frames_of(table, np.zeros(6))
    return Chain(
        base="base",
        flange="flange",
        axes=np.array([frame[:3, 2] for frame in frames[:6]]),
        points=np.array([frame[:3, 3] for frame in frames[:6]]),
        T_base_flange=frames[6],
        lower=np.full(6, -np.pi),
        upper=np.full(6, np.pi),
    )


def test_urdf_of_the_irb6600_gives_table_2_1(irb6600, table_2_1):
    np.testing.assert_array_equal(irb6600.dh, table_2_1)


lengths = st.floats(-1.5, 1.5)
angles = st.sampled_from([-np.pi / 2, 0.0, np.pi / 2, 0.3, -1.1, np.pi])


@settings(max_examples=150, deadline=None)
@given(
    rows=st.lists(st.tuples(st.floats(-3, 3), lengths, lengths, angles), min_size=5, max_size=5),
    last=st.tuples(st.floats(-3, 3), lengths),
    seed=st.integers(0, 1000),
)
def test_any_serial_chain_gives_a_table_with_its_motion(rows, last, seed, frames_of):
    # The table found may differ from the one put in (a and x flip sign together, parallel axes
    # leave d open); the motion of the flange may not.
    table = np.array([*rows, (last[0], last[1], 0.0, 0.0)])
    found = table_of_chain(chain_of(table, frames_of))
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, 6)
    np.testing.assert_allclose(frames_of(found, q)[6], frames_of(table, q)[6], atol=1e-6)


def test_a_base_beside_axis_1_is_refused(table_2_1, frames_of):
    chain = chain_of(table_2_1, frames_of)
    shifted = Chain(**{**chain.__dict__, "points": chain.points + np.array([0.1, 0, 0])})
    with pytest.raises(RobotDescriptionError, match=r"axis 1 is 1\.0e-01 m"):
        table_of_chain(shifted)


def test_a_tilted_flange_is_refused(table_2_1, frames_of):
    chain = chain_of(table_2_1, frames_of)
    tilted = chain.T_base_flange @ frames_of([[0, 0, 0, 0.1]], [0.0])[1]
    with pytest.raises(RobotDescriptionError, match="flange"):
        table_of_chain(Chain(**{**chain.__dict__, "T_base_flange": tilted}))
