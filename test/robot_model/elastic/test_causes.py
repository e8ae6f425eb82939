"""Every cause: fixed names, derivatives, units, and agreement with a physics it shares no code with."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.diagnosis.loading.patterns import unnamed_patterns
from doormill_ros.diagnosis.loading.problem import LoadingProblem as Problem
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.registry import LIBRARY, build_cause, candidates
from support.truth.loading_test import Spoil

#: Name, place and parameters of one example each, as the set description fixes them.
EXAMPLES = [
    ("joint_stiffness", "joint 2", {"stiffness": 1.5e6}),
    ("joint_backlash", "joint 1", {"gap": 1e-4, "crossing": 140.0}),
    ("joint_backlash", "joint 3", {"gap": 2e-4, "crossing": 0.0}),
    ("joint_hardening", "joint 3", {"stiffness": 1.2e6, "hardening": 8e-4}),
    ("joint_friction", "joint 2", {"torque": 60.0}),
    ("joint_cross_compliance", "joint 4", {"compliance": 2e-7}),
    ("link_bending", "link 1", {"EI": 2e7}),
    ("link_bending", "link 2", {"EI": 1e7}),
    ("base_compliance", "base", {"stiffness": 3e7}),
    ("tool_compliance", "flange", {"stiffness": 4e5}),
    ("wrench_frame_rotation", "sensor", {"angle": 0.06}),
    ("wrench_gain", "sensor", {"factor": 1.08}),
    ("tracker_frame_rotation", "tracker", {"rotation_vector": [0.02, -0.01, 0.03]}),
    ("tracker_scale", "tracker", {"factor": 0.95}),
    ("thermal_drift", "cell", {"velocity": [2e-7, -1e-7, 3e-7]}),
    ("reflector_position", "tip", {"offset": [0.02, 0.03, -0.01]}),
    ("joint_offset", "joint 4", {"angle": 0.03}),
]
IDS = [f"{name} {where}" for name, where, _ in EXAMPLES]


def flat(parameters):
    return np.concatenate([np.atleast_1d(np.asarray(v, dtype=float)) for v in parameters.values()])


@pytest.fixture
def problem(make_set):
    return Problem(make_set(seed=3, trials=60, postures=12))


def test_the_fixed_names_are_all_there_with_their_parameters():
    expected = {
        "joint_stiffness": ["stiffness"],
        "joint_backlash": ["gap", "crossing"],
        "joint_hardening": ["stiffness", "hardening"],
        "joint_cross_compliance": ["compliance"],
        "link_bending": ["EI"],
        "base_compliance": ["stiffness"],
        "tool_compliance": ["stiffness"],
        "wrench_frame_rotation": ["angle"],
        "wrench_gain": ["factor"],
        "tracker_frame_rotation": ["rotation_vector"],
        "tracker_scale": ["factor"],
        "thermal_drift": ["velocity"],
        "reflector_position": ["offset"],
        "joint_offset": ["angle"],
    }
    found = {cause.name: [p.name for p in cause.parameters] for cause in candidates(["ee"])}
    assert {name: found[name] for name in expected} == expected
    places = {(c.name, c.where) for c in candidates(["ee", "tip"])}
    assert {("joint_backlash", f"joint {k}") for k in range(1, 7)} <= places
    assert {
        ("reflector_position", "ee"),
        ("reflector_position", "tip"),
        ("base_compliance", "base"),
    } <= places
    assert len({c.identity for c in candidates(["ee"])}) == len(candidates(["ee"]))


@pytest.mark.parametrize(("name", "where", "parameters"), EXAMPLES, ids=IDS)
def test_prediction_agrees_with_the_simulated_truth(make_set, name, where, parameters):
    """Own kinematics and finite motions on one side, linear twists on the other: equal at small loads."""
    effect = {"cause": name, "where": where, "parameters": parameters}

    def quiet(plan):
        # A twentieth of the load leaves a four-hundredth of the second-order terms.
        return replace(plan, wrench=0.05 * plan.wrench, noise=(1e-12, 0.0, 0.0))

    data = make_set([effect], seed=3, trials=60, postures=12, change=quiet)
    problem = Problem(data)
    cause = build_cause(name, where)
    theta = cause.from_values(flat(parameters), problem.case)
    effect_size = np.abs(problem.predict([cause], theta).residual - problem.predict([], np.zeros(0)).residual)
    left = np.abs(problem.predict([cause], theta).residual)
    assert effect_size.max() > 0.5e-6, "the example must be large enough to prove something"
    assert left.max() < 0.004 * effect_size.max() + 5e-9


@pytest.mark.parametrize(("name", "where", "parameters"), EXAMPLES, ids=IDS)
def test_values_and_theta_are_inverse(problem, name, where, parameters):
    cause = build_cause(name, where)
    values = flat(parameters)
    np.testing.assert_allclose(cause.values(cause.from_values(values, problem.case), problem.case), values)
    assert len(values) == sum(p.size for p in cause.parameters)


@pytest.mark.parametrize(("name", "where", "parameters"), EXAMPLES, ids=IDS)
def test_derivatives_agree_with_finite_differences(make_set, name, where, parameters):
    """Alone, and behind a turned tracker, a turned sensor and a moved joint."""
    problem = Problem(make_set(seed=4, trials=40, postures=8, spoil=Spoil(unknown_directions=0.0)))
    around = [
        ("tracker_frame_rotation", "tracker"),
        ("wrench_frame_rotation", "sensor"),
        ("joint_offset", "joint 2"),
    ]
    for others in ([], [o for o in around if o[0] != name]):
        members = [build_cause(name, where), *(build_cause(*other) for other in others)]
        theta = np.concatenate(
            [members[0].from_values(flat(parameters), problem.case)]
            + [0.01 * np.ones(c.size) for c in members[1:]]
        )
        prediction = problem.predict(members, theta, derivative=True)
        hidden = members[0].hidden_state(problem.case_of(members, theta))
        # The state of a trial near zero torque is chosen anew at every theta; leave those out.
        sure = np.ones(len(problem), bool) if hidden is None else (hidden == 0.0) | (hidden == 1.0)
        assert len(theta) >= members[0].size > 0
        for i in range(len(theta)):
            step = 1e-6 * max(1.0, abs(theta[i]))
            up, down = theta.copy(), theta.copy()
            up[i] += step
            down[i] -= step
            numeric = (problem.predict(members, down).white - problem.predict(members, up).white) / (2 * step)
            own, numeric = prediction.jacobian[sure, :, i], numeric[sure]
            # Rotations are differentiated at the turned frame, forward differences are first order.
            assert np.abs(own - numeric).max() < 0.02 * np.abs(numeric).max() + 1e-6


def test_finite_joint_angles_are_those_of_the_moved_robot(problem):
    """The curvature against forward kinematics at the deflected joint angles."""
    data, case = problem.data, problem.case
    give = case.torque / data.joint_stiffness
    rows, link = np.arange(len(data)), data.reflector_link
    still, moved = (Kinematics(data.dh).link_frames(q)[rows, link] for q in (data.q, data.q + give))
    change = np.einsum("nij,nj->ni", moved[:, :3, :3] - still[:, :3, :3], data.reflector_position)
    change += moved[:, :3, 3] - still[:, :3, 3]
    np.testing.assert_allclose(case.springs()[:, :3] + case.curvature(), change, atol=1e-12)


@pytest.mark.parametrize("variant_of", ["base_compliance", "tool_compliance"])
def test_two_axes_with_equal_stiffness_are_one_stiffness(problem, variant_of):
    where = {"base_compliance": "base", "tool_compliance": "flange"}[variant_of]
    one, two = build_cause(variant_of, where), build_cause(variant_of, where, "two axes")
    np.testing.assert_allclose(
        two.twist(problem.case, np.array([0.7, 0.7])), one.twist(problem.case, np.array([0.7])), atol=1e-18
    )


def test_tracker_rotation_is_that_of_scipy(problem):
    cause = build_cause("tracker_frame_rotation", "tracker")
    d = np.random.default_rng(0).normal(size=(len(problem), 3))
    turned = cause.observe(d, problem.data.dt, np.array([0.1, 0.2, -0.3]))
    np.testing.assert_allclose(turned, Rotation.from_rotvec([0.1, 0.2, -0.3]).apply(d))


def test_no_cause_means_no_effect(problem):
    """Theta zero leaves the simulation alone, for causes and for patterns without a name."""
    data = problem.data
    everything = [
        *candidates(data.reflectors),
        *unnamed_patterns(data.q, data.time, data.temperature, data.dt),
    ]
    assert len(everything) > len(LIBRARY)
    plain = problem.predict([], np.zeros(0)).residual
    for cause in everything:
        np.testing.assert_allclose(problem.predict([cause], np.zeros(cause.size)).residual, plain, atol=1e-15)


def test_every_cause_tells_its_pattern():
    assert {cause.name for cause in candidates(["ee"])} == {kind.name for kind in LIBRARY}
    for cause in candidates(["ee"]):
        sentence = cause.pattern()
        assert len(sentence) > 30
        assert not sentence.endswith(".")


def test_every_cause_has_a_way_to_be_shown_without_loading_the_robot():
    assert all(kind.direct for kind in LIBRARY)


def test_a_place_or_a_variant_that_a_cause_does_not_have_is_refused():
    for asked in (("wrench_gain", "joint 1"), ("wrench_gain", "sensor", "two axes")):
        with pytest.raises(KeyError, match="wrench_gain"):
            build_cause(*asked)


def test_an_unknown_cause_is_refused():
    with pytest.raises(KeyError, match="gremlins"):
        build_cause("gremlins", "joint 1")
