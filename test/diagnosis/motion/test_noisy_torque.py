"""Much noise in a torque makes springs look harder: nothing is named for it, and springs come out right."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.measurements.motion_set import read_motion_set
from support.motion_world import STIFFNESS, Recording, record

NOISE = (
    1.0e-5,
    1.0e-6,
    300.0,
)  #: the last: more than the torque of joint 1 deviates by, a tenth of the others [N m]


def diagnosed(folder, hidden, seed):
    data = read_motion_set(record(folder / "set", hidden, seed))
    assert all(0.0 < motion.torque_noise < 0.3 * NOISE[2] for motion in data.motions)
    diagnosis = diagnose_motions([data])
    return diagnosis, {(one.cause, one.where): one.parameters for one in named_causes(diagnosis)}


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_noise_of_the_torque_is_no_spring(tmp_path, seed, stated):
    diagnosis, named = diagnosed(tmp_path, Recording(noise=NOISE, stated=stated, seconds=40.0), seed)
    assert (diagnosis.verdict, named) == ("consistent", {})


def test_a_spring_is_right_beside_it(tmp_path):
    hidden = Recording(noise=NOISE, seconds=40.0).with_gear(2, stiffness=0.85)
    diagnosis, named = diagnosed(tmp_path, hidden, 5)
    assert (diagnosis.verdict, list(named)) == ("explained", [("joint_stiffness", "joint 2")])
    found = named["joint_stiffness", "joint 2"]["stiffness"]
    assert found["value"] == pytest.approx(0.85 * STIFFNESS[1], abs=5.0 * found["std"])
    assert found["std"] < 0.02 * STIFFNESS[1]


def test_a_torque_that_never_turns_back_has_no_size_of_its_own(tmp_path):
    hidden = Recording(seconds=20.0).with_gear(2, stiffness=0.7, late=3e-5)
    folder = record(tmp_path / "set", hidden, 1)
    names = (folder / "samples.csv").read_text().splitlines()[0].split(",")
    table = np.loadtxt(folder / "samples.csv", delimiter=",", skiprows=1)
    torque, link = names.index("tau2"), names.index("l2")
    more = 1.2 * np.max(-np.minimum(table[:, torque], 0.0)) + 1000.0  # a load that always bears one way
    table[:, torque] += more
    table[:, link] -= more / (0.7 * STIFFNESS[1])
    np.savetxt(folder / "samples.csv", table, delimiter=",", header=",".join(names), comments="", fmt="%.12g")
    diagnosis = diagnose_motions([read_motion_set(folder)])
    assert diagnosis.verdict == "explained"
    assert {(one.cause, one.where) for one in named_causes(diagnosis)} == {
        ("joint_stiffness", "joint 2"),
        ("time_skew", "joint 2"),
    }
