"""The law of a growth: what it says at a time, how sure it is, how far it is followed, and its place in a model."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.displacement import Displacement
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import load_model_of
from doormill_ros.robot_model.warmth.grown_model import grown, growth_in
from doormill_ros.robot_model.warmth.growth import REACH, GrowthLaw, ThermalGrowth
from doormill_ros.robot_model.warmth.work_times import WorkTimes

ROBOT = load_robot("irb6600_175_255")
TIP = np.array([0.0, 0.0, 0.3])
Q = np.random.default_rng(1).uniform(-0.8, 0.8, (20, 6))
HOUR = 3600.0
ONE = ThermalGrowth((GrowthLaw(0.5, 2e-4, 4e-6, 1.0),), 1.0, 180.0)
#: The same after a quarter of an hour, whichever of the two holds; twice as far apart as ever after that.
TWO = ThermalGrowth((GrowthLaw(0.5, 2e-4, 0.0, 0.5), GrowthLaw(4.0, 1.3e-3, 0.0, 0.5)), 0.25, 180.0)


def way(growth, hours):
    takts = np.arange(0.0, HOUR * hours, growth.takt)
    found = growth.at(WorkTimes(takts), HOUR * hours)
    assert found == pytest.approx(growth.after(hours))
    return found


def written(folder, **told):
    path = folder / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(ROBOT.name, ROBOT.stiffness, (), "a test", **told)))
    return path


def test_a_growth_comes_with_the_work():
    assert way(ONE, 0.0) == (0.0, 0.0)
    for hours in (0.1, 0.5, 2.0):
        warm = 1.0 - np.exp(-hours / 0.5)
        assert way(ONE, hours) == pytest.approx((2e-4 * warm, 4e-6 * warm))
    assert ONE.at(WorkTimes(), 1e9) == (0.0, 0.0)


def test_laws_that_the_doors_did_not_tell_apart_make_the_growth_uncertain():
    near, far = way(TWO, 0.25), way(TWO, 0.5)
    each = [law.growth * -np.expm1(-0.5 / law.hours) for law in TWO.laws]
    assert far[0] == pytest.approx(np.mean(each))
    assert far[1] == pytest.approx(np.std(each))
    assert far[1] / far[0] > 2.0 * near[1] / near[0]


def test_a_law_is_followed_for_as_long_again_as_the_doors_saw_the_work_and_is_never_worse_than_nothing():
    assert way(TWO, 30.0) == pytest.approx(way(TWO, 0.5))
    seen = ThermalGrowth((GrowthLaw(4.0, 1.3e-3, 0.0, 1.0),), 0.25, 180.0)
    at_last_door = way(seen, 0.25)[0]
    for hours in np.linspace(0.25, 12.0, 40):
        # The arm could be as warm as it will be: whatever it does from then on, it does not shrink.
        assert abs(way(seen, hours)[0] - at_last_door) <= at_last_door


def test_a_model_keeps_the_law_and_is_cold_until_it_is_told_how_warm_it_is(tmp_path):
    placed = Displacement((1e-4, -2e-4, 3e-4), turn=2e-4, std=1e-5)
    plain, own = load_model_of(ROBOT, written(tmp_path, growth=TWO)), load_model_of(ROBOT)
    assert growth_in(plain) == TWO
    assert growth_in(own) is None
    wrench = np.full((20, 6), 50.0)
    assert np.array_equal(plain.deflection(Q, wrench, TIP), own.deflection(Q, wrench, TIP))
    both = load_model_of(ROBOT, written(tmp_path, growth=TWO, standing=placed))
    assert growth_in(both) == TWO
    T = Kinematics(ROBOT).forward(Q)
    tip = T[:, :3, :3] @ TIP + T[:, :3, 3]
    for cold, std in ((plain, 0.0), (both, 1e-5)):
        warm = grown(cold, Kinematics(ROBOT), TWO, 1e-4, 3e-5)
        moved = warm.deflection(Q, wrench, TIP) - cold.deflection(Q, wrench, TIP)
        assert np.allclose(np.linalg.norm(tip + moved[:, :3], axis=1), np.linalg.norm(tip, axis=1) + 1e-4)
        assert np.allclose(np.linalg.norm(moved[:, :3], axis=1), 1e-4)
        assert np.allclose(moved[:, 3:], 0.0)
        assert np.allclose(warm.standing_spread(Q, TIP, np.zeros(6)).rest, np.hypot(3e-5, std))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"laws": []}, "allowed is a list of at least one"),
        ({"laws": {}}, "allowed is a list of at least one"),
        ({"seen": -1.0}, "thermal_growth has a negative number"),
        ({"takt": -1.0}, "thermal_growth has a negative number"),
        ({"seen": float("inf")}, "thermal_growth has a number that is not finite"),
        ({"laws": [{"hours": 0.0, "growth": 1e-4, "std": 0.0, "weight": 1.0}]}, "of hours more than 0"),
        (
            {"laws": [{"hours": 1.0, "growth": 1e-4, "std": 0.0, "weight": 0.5}]},
            "add up to 0.5, allowed is 1",
        ),
        ({"laws": [{"hours": 1.0, "growth": 1e-4, "weight": 1.0}]}, "the key 'std' is missing"),
    ],
)
def test_a_law_of_no_use_is_refused(tmp_path, change, complaint):
    path = written(tmp_path, growth=ONE)
    document = yaml.safe_load(path.read_text())
    document["thermal_growth"] |= change
    path.write_text(yaml.safe_dump(document))
    with pytest.raises(ExtendedModelError, match=complaint):
        load_model_of(ROBOT, path)


def test_an_arm_that_grows_moves_its_tool_by_how_far_its_flange_is(tmp_path):
    arm = replace(TWO, arm=True)
    cold = load_model_of(ROBOT, written(tmp_path, growth=arm))
    assert growth_in(cold) == arm
    warm = grown(cold, Kinematics(ROBOT), arm, 1e-4, 3e-5)
    moved = warm.deflection(Q, np.zeros((len(Q), 6)), TIP) - cold.deflection(Q, np.zeros((len(Q), 6)), TIP)
    assert np.allclose(moved[:, :3], 1e-4 * Kinematics(ROBOT).forward(Q)[:, :3, 3] / REACH)
