"""A plan that is told the world's own figures: what a learned model leaves, these leave, also where a gap closes."""

import numpy as np
import pytest
import yaml

from doormill_ros.pipeline.plan import load_setup
from doormill_ros.simulation.world.gauge import NOISE
from support.loop_worlds import GAP, UNSEEN, milled, taught

HINGES = UNSEEN[:2]
HIDDEN = {
    "a gap": {"robot": GAP},
    "a gap and a weight": {"robot": GAP, "tool": {"mass": 15.0, "com": [0.0, 0.0, 0.1]}},
    "all but a gap": {
        "robot": {"stiffness_factor": [0.8, 1.0, 1.0, 1.0, 1.0, 1.0]},
        "tool": {"mass": 15.0, "com": [0.0, 0.0, 0.1], "stiffness": 4e6},
        "force": {"factor": 0.8, "angle": 0.2, "wear_per_door": 0.01},
        "clamp": {"shift": [0.0, 2e-4, 1e-4], "from_door": 3},
    },
}


@pytest.mark.parametrize(("name", "program", "offset"), HINGES, ids=[one[0] for one in HINGES])
def test_all_that_is_told_leaves_no_more_than_the_gauge_can_see(tmp_path, name, program, offset):
    world = tmp_path / "world.yaml"
    world.write_text(yaml.safe_dump({"schema": "doormill/world/1", **HIDDEN["all but a gap"]}))
    unaware = milled(load_setup(), world, name, program, offset)[0]
    told = milled(load_setup(), world, name, program, offset, aware=True)[0]
    assert told < NOISE
    assert unaware > 10.0 * told


@pytest.mark.parametrize("label", ["a gap", "a gap and a weight"])
def test_a_learned_gap_leaves_what_the_worlds_own_figures_leave(tmp_path, label):
    loop = taught(tmp_path, HIDDEN[label])
    aware = load_setup(model=str(loop.model))
    before = [milled(load_setup(), loop.world, *door)[0] for door in HINGES]
    after = np.array([milled(aware, loop.world, *door)[0] for door in HINGES])
    told = np.array([milled(load_setup(), loop.world, *door, aware=True)[0] for door in HINGES])
    assert (after < 1.5 * told).all()
    assert (told > 2.0 * NOISE).all()  # where a joint turns back the tool jumps, whoever plans
    assert (after < before).all()
