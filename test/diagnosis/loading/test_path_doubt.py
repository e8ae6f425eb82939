"""A model that the data leave open does not reach the path where its readings would mill elsewhere."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.kind import run
from doormill_ros.diagnosis.loading.kind import LoadingTests
from doormill_ros.robot.description import load_robot

#: Half the spring of joint 4, as the truth knows it: the force across the hinges turns it.
SOFT = {
    "cause": "joint_stiffness",
    "where": "joint 4",
    "parameters": {"stiffness": 0.5 * float(load_robot("irb6600_175_255").stiffness[3])},
}


def pull_one_way(plan):
    """One posture, one reflector, one direction of load: a single length says how much, and hardly what."""
    size = np.linspace(0.3, 1.0, len(plan.q))[:, None]
    return replace(plan, wrench=plan.wrench[:1] * size, reflector=plan.reflector[:1] * len(plan.q))


@pytest.mark.parametrize(("change", "told"), [(pull_one_way, False), (lambda plan: plan, True)])
def test_the_path_keeps_the_model_in_question_where_readings_part(make_set, tmp_path, change, told) -> None:
    data = make_set([SOFT], seed=4, trials=20, postures=1, change=change)
    out = tmp_path / "out"
    run(LoadingTests(), [data.path], [], out)
    document = json.loads((out / "diagnosis.json").read_text())
    model = yaml.safe_load((out / "model.yaml").read_text())
    assert document["causes"]
    assert bool(model["causes"]) == told
    assert ("model_unchanged" in document) != told
    if not told:
        assert "these data cannot tell" in document["model_unchanged"]
        assert document["model_unchanged"] in str(model)
