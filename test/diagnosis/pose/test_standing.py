"""Robots that hang, lean or carry what no set states: the right names all the same, and the assumption contradicted."""

import json

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.pose.link_masses import LinkMass
from doormill_ros.robot_model.pose.model import PoseModel, load_pose_model, model_document
from doormill_ros.robot_model.pose.stance import UPRIGHT, Stance
from support.arms import SIX, torque

MASSES = (60.0, 50.0, 30.0, 15.0, 8.0, 3.0)
SAG = [(2, 2e-6), (3, 3e-6)]
#: A joint whose axis is upright carries nothing, unless the robot leans.
LEANING = [(1, 4e-6), *SAG]
LEANT = (0.2, 0.3, -np.sqrt(1.0 - 0.13))
GEOMETRY, WAVE = [(3, "alpha", 2e-4)], [(2, 3, 1.5e-4, 0.4)]
LOAD = (12.0, (0.06, -0.02, 0.15))
CASES = {
    "ceiling": {"down": (0.0, 0.0, 1.0), "sag": SAG, "geometry": GEOMETRY},
    "wall": {"down": (0.0, 1.0, 0.0), "sag": LEANING, "periodic": WAVE},
    "leaning": {"down": LEANT, "sag": LEANING, "geometry": GEOMETRY},
    "load": {"load": LOAD, "sag": SAG, "periodic": WAVE},
    "load, leaning": {"load": LOAD, "down": LEANT, "sag": LEANING},
}


@pytest.fixture
def diagnose(tmp_path, write_arm_sets, arm):
    def run(rows=145, seed=7, **case):
        one = arm(dh=SIX, masses=MASSES, names=("one", "two", "new"), noise=2.5e-5, **case)
        folders = write_arm_sets(tmp_path / "data", one, rows, seed)
        run_kind(Poses(), folders[:2], folders[2:], tmp_path / "out")
        document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
        return document, {(c["cause"], c["where"]): c["parameters"] for c in document["causes"]}, one

    return run


@pytest.mark.parametrize("name", CASES)
def test_what_gravity_does_is_laid_on_nothing_else(diagnose, name):
    case = CASES[name]
    document, found, _ = diagnose(**case)
    expected = {("joint_sag", f"joint {joint}") for joint, _ in case["sag"]}
    expected |= {("link_geometry", f"link {link}") for link, *_ in case.get("geometry", ())}
    expected |= {("joint_periodic_error", f"joint {joint}") for joint, *_ in case.get("periodic", ())}
    assert document["verdict"] == "explained"
    assert set(found) == expected
    assert document["extended"]["holdout_rmse"] < 1.05 * document["noise_floor"]
    # The check needs the stance, too: its own set.yaml tells it as little.
    assert document["checks"][0]["extended"]["rmse"] < 1.15 * document["noise_floor"]
    standing = document["standing"]
    down = np.array(case.get("down", (0.0, 0.0, -1.0)))
    off = np.arccos(np.clip(down @ standing["down"], -1.0, 1.0))
    assert off < (4.0 * standing["tilt"]["std"] if "down" in case else 1e-9)
    assert ("tilt" in standing) == ("down" in case)
    assert any("how does the robot stand?" in line for line in document["remarks"]) == ("down" in case)
    assert ("load" in standing) == ("load" in case)
    assert any("what hangs there" in line for line in document["remarks"]) == ("load" in case)
    if "down" in case:
        assert standing["tilt"]["std"] < np.radians(1.0)
    if "load" in case:
        mass = standing["mass"]
        assert abs(mass["value"] - LOAD[0]) < 4.0 * mass["std"] < 0.5 * LOAD[0]
        np.testing.assert_allclose(standing["load"]["com"], LOAD[1], atol=0.05)


def test_the_model_bends_as_the_robot_that_leans(diagnose, tmp_path):
    document, found, one = diagnose(**CASES["leaning"])
    model = load_pose_model(tmp_path / "out")
    np.testing.assert_allclose(model.stance.down, document["standing"]["down"], atol=1e-12)
    q = np.random.default_rng(3).uniform(-1.8, 1.8, (50, 6))
    moment = model.view(q).gravity_moment
    for joint, compliance in LEANING:
        assert found["joint_sag", f"joint {joint}"]["compliance"]["value"] == pytest.approx(
            compliance, rel=0.15
        )
        true = torque(q, joint, one)
        assert np.abs(moment[:, joint - 1, 2] - true).max() < 0.03 * np.abs(true).max() + 0.5


@pytest.mark.parametrize("more", [{}, {"geometry": GEOMETRY}, {"periodic": WAVE}, {"strange": 1e-4}])
@pytest.mark.parametrize("sag", [SAG, []], ids=["soft", "stiff"])
def test_an_upright_robot_is_told_to_stand_nowhere_else(diagnose, tmp_path, more, sag):
    document, *_ = diagnose(sag=sag, **more)
    assert "standing" not in document
    assert not any("how does" in line or "what hangs" in line for line in document["remarks"])
    assert load_pose_model(tmp_path / "out").stance is UPRIGHT
    assert "stance" not in (tmp_path / "out" / "model.yaml").read_text()


class TestStance:
    def test_a_load_is_a_part_of_the_last_link(self):
        links = (LinkMass(5.0, np.zeros(3)), LinkMass(2.0, np.array([0.0, 0.0, 0.1])))
        first, last = Stance(load=LinkMass(6.0, np.array([0.2, 0.0, 0.1]))).carried(links)
        assert first is links[0]
        assert last.mass == 8.0
        np.testing.assert_allclose(last.com, [0.15, 0.0, 0.1])
        assert UPRIGHT.carried(links) == links

    def test_a_file_keeps_it_and_one_without_a_direction_is_refused(self, tmp_path):
        hung = Stance(np.array([0.0, 0.6, 0.8]), LinkMass(6.0, np.array([0.2, 0.0, 0.1])))
        model = PoseModel("invented", np.array(SIX), (), (), np.zeros(0), stance=hung)
        path = tmp_path / "model.yaml"
        path.write_text(yaml.safe_dump(document := model_document(model, "test")))
        again = load_pose_model(path).stance
        np.testing.assert_array_equal(again.down, hung.down)
        assert again.load.mass == 6.0
        document["stance"]["down"] = [0.0, 0.0, 0.5]
        path.write_text(yaml.safe_dump(document))
        with pytest.raises(PoseModelError, match="unit vector"):
            load_pose_model(path)
