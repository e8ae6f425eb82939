"""A wrong link that a law without a name had hidden is named beside it, with its size; a law alone lends no name."""

import numpy as np
import pytest

from doormill_ros.diagnosis.pose import laws as pose_laws
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.laws import numbers_told, with_laws
from doormill_ros.measurements.sets.pose_set import read_pose_set
from support.pose_laws.laws import coupled_wrist, neighbour_sag, rocking_base
from support.pose_laws.world import World


def diagnosed(folder, law, seed, longer=0.0):
    """What the causes alone say of an arm with a law of eight times the noise and a link 2 longer than stated."""
    hidden = World(seed, law(np.random.default_rng(seed)), 8.0, np.array([0.0, longer, 0.0, 0.0, 0.0, 0.0]))
    return hidden.law, diagnose_poses([read_pose_set(hidden.write(folder))])


def names(diagnosis):
    return [cause.key for cause in diagnosis.examination.named]


@pytest.mark.parametrize("law", [neighbour_sag, coupled_wrist, rocking_base])
def test_a_length_that_a_law_had_hidden_is_named_beside_it(tmp_path, law):
    longer = 8e-5
    hidden, before = diagnosed(tmp_path / "set", law, 3, longer)
    assert names(before) == []
    after = with_laws(before)
    assert (after.verdict, names(after)) == ("partly_explained", [("link_geometry", "link 2")])
    assert [(one.where, one.driver) for one in after.laws.laws] == [(hidden.where, hidden.driver)]
    fit, std = numbers_told(after)
    ((cause, part),) = after.extended.parts
    true = [longer if name == "a" else 0.0 for name in cause.names]
    assert np.all(np.abs(fit.x[part] - true) < 4.0 * std[part])
    assert std[part][cause.names.index("a")] < 0.05 * longer


@pytest.mark.parametrize("law", [neighbour_sag, coupled_wrist, rocking_base])
def test_a_law_alone_takes_no_name_when_causes_are_asked_for_again(tmp_path, law, monkeypatch):
    _, before = diagnosed(tmp_path / "set", law, 3)
    asked = []
    own = pose_laws.asked_beside
    monkeypatch.setattr(pose_laws, "asked_beside", lambda *given: asked.append(given) or own(*given))
    after = with_laws(before)
    assert (after.verdict, names(after)) == ("unexplained", [])
    assert asked
