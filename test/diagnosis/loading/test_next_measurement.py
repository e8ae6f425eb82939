"""The proposed trials do tell the candidates apart, far better than as many trials at random."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.loading.next_measurement import plan_next
from doormill_ros.diagnosis.loading.problem import LoadingProblem as Problem
from doormill_ros.simulation.truth.chain import turn
from support.diagnoses import diagnose_set
from support.truth.loading_test import LoadingPlan, true_displacement

BASE = {"cause": "base_compliance", "where": "base", "parameters": {"stiffness": 3e7}}
GAIN = {"cause": "wrench_gain", "where": "sensor", "parameters": {"factor": 1.1}}


def carry_out(plan_set, dh, effects, seed):
    """Measure planned trials on the simulated truth."""
    rng = np.random.default_rng(seed)
    n = len(plan_set)
    to_flange = turn(np.array([[0.0, 0.0, plan_set.wrench_frame_rotation]]))[0]
    wrench = np.hstack([plan_set.wrench[:, :3] @ to_flange.T, plan_set.wrench[:, 3:] @ to_flange.T])
    lab = LoadingPlan(
        q=plan_set.q,
        direction=plan_set.direction,
        wrench=wrench,
        reflector=tuple(plan_set.reflector),
        time=np.arange(n),
        dt=plan_set.dt,
        temperature=np.full(n, np.nan),
        reflectors={k: (r.link, r.position) for k, r in plan_set.reflectors.items()},
        dh=dh,
        load_point=plan_set.load_point,
        stiffness=plan_set.joint_stiffness,
    )
    measured = true_displacement(lab, effects) + rng.normal(0.0, plan_set.noise.displacement, (n, 3))
    return type(plan_set)(**{**vars(plan_set), "displacement": measured, "trial": np.arange(1, n + 1)})


def odds(data, favourite, rival):
    """How much better the favourite predicts trials neither has seen (squared distance)."""
    problem = Problem(data)
    return sum(
        sign * problem.predict(found.members, found.theta).cost.sum()
        for sign, found in ((1.0, rival), (-1.0, favourite))
    )


def test_proposed_trials_separate_a_tilting_base_from_a_tilting_bearing(make_set, dh):
    data = make_set([BASE], seed=31)
    diagnosis = diagnose_set(data)
    keys = {diagnosis.findings[0].cause.key, *(c.key for c in diagnosis.findings[0].confusable)}
    assert keys == {("base_compliance", "base"), ("joint_cross_compliance", "joint 1")}
    plan = plan_next(diagnosis)
    assert plan.odds > 4.6
    assert all("link 0" in trial.reflector for trial in plan.trials), "only the base itself can tell"
    problem = diagnosis.problem
    library = {c.key: c for c in diagnosis.search.candidates if not c.variant}
    base = fit(problem, [library["base_compliance", "base"]])
    bearing = fit(problem, [library["joint_cross_compliance", "joint 1"]])
    assert abs(odds(data, base, bearing)) < 1e-3, "the data in hand say nothing"
    assert odds(carry_out(plan.plan, dh, [BASE], seed=1), base, bearing) > 9.2
    # The other way round: the truth is the bearing, and the same trials say so.
    tilt = {"cause": "joint_cross_compliance", "where": "joint 1", "parameters": {"compliance": 1 / 3e7}}
    assert odds(carry_out(plan.plan, dh, [tilt], seed=2), base, bearing) < -9.2


def test_proposed_trials_beat_random_ones(make_set, dh):
    """Two laws of one joint that little data leave open: proposed trials gain several times more."""
    effect = {
        "cause": "joint_hardening",
        "where": "joint 2",
        "parameters": {"stiffness": 1.9e6, "hardening": 3e-4},
    }
    data = make_set([effect], seed=33, trials=24, postures=6)
    diagnosis = diagnose_set(data)
    plan = plan_next(diagnosis)
    assert plan.plan is not None
    problem = diagnosis.problem
    library = {c.key: c for c in diagnosis.search.candidates if not c.variant}
    law = fit(problem, [library["joint_hardening", "joint 2"]])
    line = fit(problem, [library["joint_stiffness", "joint 2"]])
    proposed = odds(carry_out(plan.plan, dh, [effect], seed=3), law, line)
    random = [
        odds(make_set([effect], seed=100 + s, trials=len(plan.plan), postures=len(plan.plan)), law, line)
        for s in range(5)
    ]
    assert proposed > 2.0 * np.median(random)


def test_it_says_when_no_loading_can_tell(make_set):
    plan = plan_next(diagnose_set(make_set([GAIN], seed=34)))
    assert {plan.favourite, plan.rival} == {"wrench_gain at sensor", "tracker_scale at tracker"}
    assert plan.odds < 0.1
    assert "No loading" in plan.sentence


@pytest.mark.parametrize("effects", [[], [GAIN, BASE]])
def test_there_is_always_one_sentence(make_set, effects):
    sentence = plan_next(diagnose_set(make_set(effects, seed=35))).sentence
    assert len(sentence) > 20
    assert "\n" not in sentence
    assert sentence.endswith(".")
