"""One file and one line make a cause: the library asks each where it may act, and rebuilds it from a model's file."""

import numpy as np
import pytest

from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.causes import registry
from doormill_ros.robot_model.pose.causes.cause import Coefficient, PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints, places_of_joints

JOINTS = places_of_joints(6)


@pytest.fixture
def hints(tmp_path, write_pose_sets, faults):
    folders = write_pose_sets(tmp_path, faults(names=["one", "two"]), 40, 51)
    sets = [read_pose_set(folder) for folder in folders]
    return Hints([data.view for data in sets], dict.fromkeys(JOINTS, (1, 2, 7)), {1: (20, 1)}, scaled=True)


def test_every_cause_of_the_robot_comes_back_from_its_settings(hints):
    dh = hints.sets[0].dh
    own = [cause for cause in registry.candidates(hints) if cause.of_robot]
    assert {cause.name for cause in own} == {kind.name for kind in registry.LIBRARY if kind.of_robot}
    for cause in own:
        again = registry.build_cause(cause.name, cause.where, cause.settings, dh)
        assert (again.key, again.coefficients) == (cause.key, cause.coefficients)


def test_places_are_those_at_which_a_cause_can_act(hints):
    keys = {cause.key for cause in registry.candidates(hints)}
    assert ("session_step", "set two") in keys
    assert ("session_step", "set one") not in keys
    assert ("thermal_drift", "set one") in keys
    assert ("link_geometry", "link 6") not in keys, "the target on the flange imitates it"
    quiet = Hints(hints.sets, hints.orders, drift=False)
    assert not any(cause.name in ("thermal_drift", "session_step") for cause in registry.candidates(quiet))


def test_a_new_cause_needs_its_line_only(hints, monkeypatch):
    class Bent(PoseCause):
        name = "bent"

        @property
        def coefficients(self):
            return (Coefficient("angle", "rad", f"bent {self.where}", 1e-3),)

    with pytest.raises(ValueError, match="bent"):
        registry.build_cause("bent", "joint 2", {}, np.zeros((6, 4)))
    monkeypatch.setattr(registry, "LIBRARY", (*registry.LIBRARY, Bent))
    assert [c.where for c in registry.candidates(hints) if c.name == "bent"] == list(JOINTS)
    assert registry.build_cause("bent", "joint 2", {}, np.zeros((6, 4))).key == ("bent", "joint 2")
