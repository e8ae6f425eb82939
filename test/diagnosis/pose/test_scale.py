"""A tracker whose lengths are all off by one share: one number, not the lengths of every link."""

import json

import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.robot_model.pose.model import load_pose_model
from support.arms import SIX

MASSES = (60.0, 50.0, 30.0, 15.0, 8.0, 3.0)
SAG = [(2, 2e-6), (3, 3e-6)]
SCALED = ("tracker_scale", "tracker")


@pytest.fixture
def diagnose(tmp_path, write_arm_sets, arm):
    def run(dh=SIX, masses=MASSES, **case):
        one = arm(dh=dh, masses=masses, names=("one", "two", "new"), noise=2.5e-5, **case)
        folders = write_arm_sets(tmp_path / "data", one, 145, 11)
        run_kind(Poses(), folders[:2], folders[2:], tmp_path / "out")
        document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
        return document, {(c["cause"], c["where"]): c for c in document["causes"]}

    return run


@pytest.mark.parametrize(
    ("scale", "more"),
    [
        (3e-5, {}),
        (1e-4, {"sag": SAG, "geometry": [(4, "d", 3e-4)]}),
        (-1.5e-4, {"sag": SAG, "geometry": [(3, "alpha", 3e-4)], "periodic": [(2, 3, 1.5e-4, 0.4)]}),
    ],
)
def test_one_share_is_told_as_one_number(diagnose, tmp_path, scale, more):
    document, found = diagnose(scale=scale, **more)
    expected = {SCALED}
    expected |= {("joint_sag", f"joint {joint}") for joint, _ in more.get("sag", ())}
    expected |= {("link_geometry", f"link {link}") for link, *_ in more.get("geometry", ())}
    expected |= {("joint_periodic_error", f"joint {joint}") for joint, *_ in more.get("periodic", ())}
    assert document["verdict"] == "explained"
    assert set(found) == expected
    factor = found[SCALED]["parameters"]["factor"]
    assert abs(factor["value"] - 1.0 - scale) < 4.0 * factor["std"] < 0.5 * abs(scale)
    others = {(one["cause"], one["where"]) for one in found[SCALED]["confusable_with"]}
    assert ("link_geometry", "link 2") in others
    assert any("One share explains" in line and "scale bar" in line for line in document["remarks"])
    for link, name, size in more.get("geometry", ()):
        entry = found["link_geometry", f"link {link}"]["parameters"][name]
        assert abs(entry["value"] - size) < 4.0 * entry["std"] < 0.2 * size
    # The model holds what the tracker sees: another set of the same tracker is predicted.
    assert document["checks"][0]["extended"]["rmse"] < 1.15 * document["noise_floor"]
    assert SCALED in {cause.key for cause in load_pose_model(tmp_path / "out").causes}


@pytest.mark.parametrize(
    "geometry",
    [
        [(2, "a", 1e-4)],
        [(2, "a", 1e-4), (4, "d", -1e-4)],
        [(1, "a", 8e-5), (2, "a", -1.1e-4), (3, "a", 9e-5), (4, "d", 1.2e-4), (5, "d", -7e-5)],
        # A share in common that neither temperature nor a tracker gives: two lengths of a measured UR10 have it.
        [(1, "a", 3.2e-4), (2, "a", -1.2e-3), (3, "a", 2e-4), (4, "d", 8.85e-4)],
    ],
)
def test_lengths_that_have_no_share_in_common_stay_lengths(diagnose, geometry):
    document, found = diagnose(geometry=geometry, sag=SAG)
    expected = {("link_geometry", f"link {link}") for link, *_ in geometry}
    assert set(found) == expected | {("joint_sag", f"joint {joint}") for joint, _ in SAG}
    assert not any("One share" in line for line in document["remarks"])


def test_two_lengths_that_agree_by_chance_among_many_stay_lengths(diagnose):
    geometry = [
        (1, "a", 2.1e-4),
        (2, "a", -9.8e-5),
        (3, "a", 1.7e-4),
        (4, "d", -8.85e-5),
        (4, "a", 9e-5),
        (5, "d", 1e-4),
    ]
    document, found = diagnose(geometry=geometry, sag=SAG)
    assert SCALED not in found
    for link in (2, 4):
        others = found["link_geometry", f"link {link}"]["confusable_with"]
        assert SCALED in {(one["cause"], one["where"]) for one in others}
    assert not any("One share" in line for line in document["remarks"])
