"""Much noise in a torque makes springs look harder: nothing is named for it, and springs come out right."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.patterns import unnamed_patterns
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.robot_model.motion.view import JointMotion
from support.motion_world import STIFFNESS, Recording, record

NOISE = (
    1.0e-5,
    1.0e-6,
    300.0,
)  #: the last: more than the torque of joint 1 deviates by, a tenth of the others [N m]


def diagnosed(folder, hidden, seed):
    data = read_motion_set(record(folder / "set", hidden, seed))
    assert all(0.0 < motion.torque_noise < 0.3 * hidden.noise[2] for motion in data.motions)
    diagnosis = diagnose_motions([data])
    return diagnosis, {(one.cause, one.where): one.parameters for one in named_causes(diagnosis)}


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_noise_of_the_torque_is_no_spring(tmp_path, seed, stated):
    diagnosis, named = diagnosed(tmp_path, Recording(noise=NOISE, stated=stated, seconds=40.0), seed)
    assert (diagnosis.verdict, named) == ("consistent", {})


@pytest.mark.parametrize("seed", [0, 1])
def test_a_torque_that_is_nearly_all_noise_names_no_spring(tmp_path, seed):
    # Joint 1 deviates by some 180 N m: even what the filter leaves, 100, makes its spring look half as hard again.
    hidden = Recording(noise=(1.0e-5, 1.0e-6, 900.0), seconds=40.0)
    _, named = diagnosed(tmp_path, hidden, seed)
    assert named == {}


@pytest.mark.parametrize(("load", "offered"), [(0.0, True), (1e5, False), (-1e5, False)])
def test_the_size_of_a_torque_that_never_turns_back_is_no_shape_of_its_own(load, offered):
    time = np.arange(2000) / 250.0
    swing = np.sin(time)
    torque = 800.0 * np.sin(3.0 * time) + load
    joint = JointMotion(1, time, swing, swing - torque / STIFFNESS[0], torque, 250.0, STIFFNESS[0])
    spoken = [pattern.spoken for pattern in unnamed_patterns(0, [[joint]])]
    assert ("the size of its torque" in spoken) == offered
    assert "the size of its speed" in spoken


def test_a_spring_is_right_beside_it(tmp_path):
    hidden = Recording(noise=NOISE, seconds=40.0).with_gear(2, stiffness=0.85)
    diagnosis, named = diagnosed(tmp_path, hidden, 5)
    assert (diagnosis.verdict, list(named)) == ("explained", [("joint_stiffness", "joint 2")])
    found = named["joint_stiffness", "joint 2"]["stiffness"]
    assert found["value"] == pytest.approx(0.85 * STIFFNESS[1], abs=5.0 * found["std"])
    assert found["std"] < 0.02 * STIFFNESS[1]
