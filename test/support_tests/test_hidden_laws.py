"""What each hidden law does, and that nothing but its driver steers it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from support.law_worlds import memory, springs, surroundings
from support.law_worlds.geometry import base_edge, joint
from support.law_worlds.law import DRIVERS, around_its_mean
from support.law_worlds.named import Named
from support.law_worlds.session import REFLECTORS, draw_session
from support.law_worlds.world import LAWS


@pytest.fixture(scope="module")
def session():
    return draw_session(np.random.default_rng(6))


def laws(make, session, count=24):
    return [make(np.random.default_rng([seed, 9]), session) for seed in range(count)]


def one(make, session, form=""):
    """The first of a form."""
    return next(law for law in laws(make, session) if law.form == form)


def turn(law, session):
    ((_, angle),) = law.effect(session).turns
    return angle


def does(law, session):
    """Everything a law does, as one array."""
    effect = law.effect(session)
    return np.concatenate(
        [np.ravel(part) for part in (*(angle for _, angle in effect.turns), effect.reading, effect.apparent)]
    )


def test_laws_say_what_the_contract_allows(session) -> None:
    drawn = [law for make in LAWS for law in laws(make, session)]
    assert len({law.name for law in drawn}) == 16
    assert {plain(law.driver) for law in drawn} == set(DRIVERS) - {"speed"}
    assert {plain(driver) for law in drawn for driver in law.also} <= set(DRIVERS)
    places = {f"{kind} {k}" for kind, numbers in (("joint", range(1, 7)), ("link", (2, 4))) for k in numbers}
    places |= {"tool", "base", "sensor", "tracker", *(f"reflector {name}" for name in REFLECTORS)}
    assert {law.where for law in drawn} == places


def plain(driver: str) -> str:
    head, _, last = driver.rpartition(" ")
    return f"{head} k" if last.isdigit() else driver


#: Columns that steer a law besides posture and load, by law and form.
STEERED = {
    ("creep", "exponential"): {"dt"},
    ("creep", "logarithmic"): {"dt"},
    ("warming", "start"): {"t"},
    ("warming", "room"): {"air"},
    ("direction_spring", ""): {"approach"},
    ("hysteresis", ""): {"approach"},
    ("turning_tracker", ""): {"t", "dt"},
}


@pytest.mark.parametrize("make", LAWS, ids=lambda make: make.__name__)
def test_only_its_driver_steers_a_law(session, make) -> None:
    other = {
        "t": session.t * 1.3,
        "dt": session.dt[::-1],
        "air": session.air[::-1],
        "approach": -session.approach,
    }
    drawn = {law.form: law for law in laws(make, session)}
    assert 1 <= len(drawn) <= 2
    steered = {
        (law.name, form): {
            column
            for column, values in other.items()
            if not np.allclose(does(law, session), does(law, replace(session, **{column: values})), rtol=1e-9)
        }
        for form, law in drawn.items()
    }
    assert steered == {key: STEERED.get(key, set()) for key in steered}


def test_creep_is_that_of_a_spring_beside_a_damper(session) -> None:
    law = one(springs.creep, session, "exponential")
    constant = law.parameters["time_constant"]
    last = solve_ivp(lambda t, x: (1.0 - x) / constant, (0.0, 200.0), [0.0], dense_output=True, rtol=1e-9).sol
    whole = turn(law, replace(session, dt=np.full(len(session.q), 1e9)))
    np.testing.assert_allclose(turn(law, session), whole * last(session.dt)[0], rtol=1e-5, atol=1e-15)


def test_logarithmic_creep_slows_as_one_over_time(session) -> None:
    law = one(springs.creep, session, "logarithmic")
    after = [
        turn(law, replace(session, dt=np.full(len(session.q), dt))) for dt in (0.0, 49.0, 51.0, 99.0, 101.0)
    ]
    np.testing.assert_allclose(after[0], 0.0, atol=1e-18)
    constant = law.parameters["time_constant"]
    ratio = (after[4] - after[3]) / (after[2] - after[1])
    np.testing.assert_allclose(ratio, (constant + 50.0) / (constant + 100.0), rtol=1e-3)


def test_gear_waves_have_one_line_in_their_spectrum(session) -> None:
    law = one(springs.gear_waves, session)
    k, n = int(law.where[-1]), len(session.q)
    q = np.tile(session.q[:1], (n, 1))
    q[:, k - 1] = 2.0 * np.pi * np.arange(n) / n
    swept = replace(session, q=q)
    spectrum = np.abs(np.fft.rfft(turn(law, swept) / swept.torque(joint(k))))
    assert np.argmax(spectrum) == law.parameters["waves"]
    assert np.sort(spectrum)[-2] < 1e-6 * spectrum.max()
    assert 2 <= law.parameters["waves"] <= 30


def test_a_one_sided_spring_gives_on_one_side(session) -> None:
    law = next(law for law in laws(springs.one_sided_spring, session) if law.hinge)
    torque = session.torque(law.hinge) * law.parameters["side"]
    np.testing.assert_array_equal(turn(law, session)[torque < 0.0], 0.0)
    against = replace(session, force=-session.force, couple=-session.couple)
    np.testing.assert_array_equal(turn(law, against)[torque > 0.0], 0.0)
    assert np.all(np.abs(turn(law, session)[torque > 0.0]) > 0.0)


def test_a_coupled_joint_follows_the_other_torque(session) -> None:
    law = one(springs.coupling, session)
    other = joint(int(law.driver[-1]))
    ratio = turn(law, session) / session.torque(other)
    np.testing.assert_allclose(ratio, law.hinge.compliance, rtol=1e-9)
    assert law.driver[-1] != law.where[-1]


def test_softening_starts_sound_and_grows(session) -> None:
    law = next(law for law in laws(memory.softening, session) if law.hinge)
    share = turn(law, session) / (law.hinge.compliance * session.torque(law.hinge))
    assert share[0] == 0.0
    assert np.all(np.diff(share) > 0.0)
    assert 0.9 < share[-1] < 1.0
    before = np.abs(session.torque(law.hinge))[:1].sum() / law.parameters["whole"]
    assert share[1] == pytest.approx(before ** law.parameters["power"])
    # A loading that never was leaves it sounder from there on.
    force, couple = session.force.copy(), session.couple.copy()
    force[10], couple[10] = 0.0, 0.0
    rested = turn(law, replace(session, force=force, couple=couple))
    np.testing.assert_array_equal(rested[:10], turn(law, session)[:10])
    assert np.all(np.abs(rested[11:]) < np.abs(turn(law, session)[11:]))


def test_a_closed_loop_of_load_costs_the_work_of_friction() -> None:
    """A play element of radius r, driven between -A and A, encloses 4 r (A - r)."""
    r, A = 2.0, 10.0
    quarter = np.linspace(0.0, 1.0, 2001)
    path = A * np.concatenate([quarter, quarter[::-1], -quarter, -quarter[::-1], quarter, quarter[::-1]])
    state = memory.play_steps(path, np.array([r]), np.ones(1), np.zeros(1))[:, 0]
    peak = len(quarter) - 1
    loop = slice(peak, peak + 4 * len(quarter) + 1)
    area = np.sum(0.5 * (path[loop][1:] + path[loop][:-1]) * np.diff(state[loop]))
    assert abs(area) == pytest.approx(4.0 * r * (A - r), rel=1e-3)


def test_an_inner_loop_is_forgotten_when_it_closes() -> None:
    """Return-point memory, what makes an operator one of Preisach's."""
    radii, weights = np.array([1.0, 3.0, 5.0]), np.full(3, 1 / 3)
    states = memory.play_steps(np.array([12.0, 4.0, 9.0, 4.0, 12.0]), radii, weights, -radii)
    np.testing.assert_allclose(states[3], states[1], atol=1e-12)
    np.testing.assert_allclose(states[4], states[0], atol=1e-12)
    # Within, the smallest element alone went from 4 + 1 to 9 - 1, a third of it in the sum.
    np.testing.assert_allclose(states[2] - states[1], [1.0, 0.0, 0.0], atol=1e-12)


def test_hysteresis_begins_with_the_direction_and_keeps_what_loadings_left(session) -> None:
    law = one(memory.hysteresis, session)
    radii, weights = np.array(law.parameters["radii"]), np.array(law.parameters["weights"])
    torque, felt = session.torque(law.hinge), turn(law, session) / law.hinge.compliance
    first = np.flatnonzero(np.diff(session.stance, prepend=-1) > 0)
    along = session.approach[first, law.hinge.link - 1] * torque[first] > 0.0
    np.testing.assert_allclose(felt[first[along]], torque[first[along]], rtol=1e-9)
    against = first[~along]
    held = np.maximum(np.abs(torque[against])[:, None] - 2.0 * radii, 0.0) @ weights
    np.testing.assert_allclose(np.abs(felt[against]), held, rtol=1e-9, atol=1e-12)
    # The second loading of a stance depends on the first.
    force, couple = session.force.copy(), session.couple.copy()
    force[first], couple[first] = -force[first], -couple[first]
    changed = turn(law, replace(session, force=force, couple=couple)) / law.hinge.compliance
    assert np.mean(np.abs(changed - felt)[first + 1] > 1e-6) > 0.3


def test_a_settling_reflector_steps_alike_in_its_link(session) -> None:
    law = one(surroundings.reflector_slip, session, "settling")
    mine = session.reflector == law.where.removeprefix("reflector ")
    step = law.effect(session).apparent
    np.testing.assert_array_equal(step[~mine], 0.0)
    R = session.frames[np.arange(len(session.q)), session.links, :3, :3]
    local = np.einsum("nji,nj->ni", R, step)[mine]
    np.testing.assert_allclose(local, np.tile(law.parameters["step"], (mine.sum(), 1)), atol=1e-15)


def test_the_sensor_errs_in_its_own_axes_and_moves_nothing(session) -> None:
    bias, mixed = (
        one(make, session).effect(session)
        for make in (surroundings.sensor_bias, surroundings.sensor_crosstalk)
    )
    assert bias.turns == mixed.turns == ()
    assert bias.apparent == mixed.apparent == 0.0
    np.testing.assert_array_equal(np.ptp(bias.reading, axis=0), 0.0)
    assert np.linalg.norm(bias.reading[0, :3]) == pytest.approx(1.0)
    law = one(surroundings.sensor_crosstalk, session)
    into, of = ("xyz".index(law.parameters[word]) for word in ("into", "of"))
    np.testing.assert_allclose(mixed.reading[:, into], session.in_sensor_axes()[:, of])
    np.testing.assert_array_equal(np.delete(mixed.reading, into, axis=1), 0.0)
    assert into != of


def test_a_turning_tracker_moves_all_reflectors_as_one_body(session) -> None:
    law = one(surroundings.turning_tracker, session)
    shift, lever = law.effect(session).apparent, session.points - law.parameters["station"]
    np.testing.assert_allclose(np.sum(shift * lever, axis=1), 0.0, atol=1e-18)
    np.testing.assert_allclose(shift @ law.parameters["axis"], 0.0, atol=1e-18)
    twice = law.effect(replace(session, dt=2.0 * session.dt)).apparent
    np.testing.assert_allclose(twice, 2.0 * shift, rtol=1e-12)


def test_the_foot_falls_over_its_edge(session) -> None:
    edge = base_edge(0.7, 0.4)
    out = np.tile([np.cos(0.7), np.sin(0.7), 0.0], (len(session.q), 1))
    pushed = replace(session, force=100.0 * out, couple=np.zeros_like(out))
    height = (pushed.frames[:, 6] @ np.append(pushed.load_point, 1.0))[:, 2]
    np.testing.assert_allclose(pushed.torque(edge), 100.0 * height, rtol=1e-12)
    moved = pushed.moved([(edge, np.full(len(out), 1e-6))])
    np.testing.assert_allclose(np.sum(moved * out, axis=1), 1e-6 * session.points[:, 2], rtol=1e-4)


@pytest.mark.parametrize("make", LAWS[:2], ids=lambda make: make.__name__)
def test_around_its_mean_a_law_has_no_slope_left(session, make) -> None:
    law = next(law for law in laws(make, session) if law.hinge)
    rows, torque = session.seen, session.torque(law.hinge)
    assert abs(turn(law, session)[rows] @ torque[rows]) > 0.01
    around = around_its_mean(law, law.hinge, session)
    assert abs(turn(around, session)[rows] @ torque[rows]) < 1e-9
    # The stated spring less its mean share still pushes back.
    assert around.largest * around.parameters["mean_compliance"] < law.hinge.compliance


def test_named_causes_keep_to_the_contract(session) -> None:
    torque = session.torque(joint(2))
    against = session.approach[:, 1] * torque < 0.0
    _, gap = Named("joint_backlash", 2, 1e-4).turn(session)
    np.testing.assert_allclose(gap, np.where(against, 0.0, 1e-4 * np.sign(torque)))
    _, half = Named("joint_stiffness", 2, 0.5 / joint(2).compliance).turn(session)
    np.testing.assert_allclose(half, torque * joint(2).compliance, rtol=1e-9)
    _, held = Named("joint_friction", 2, 50.0).turn(session)
    left = torque * joint(2).compliance + held
    spring = np.where(against, np.sign(torque) * np.maximum(np.abs(torque) - 50.0, 0.0), torque)
    np.testing.assert_allclose(left, spring * joint(2).compliance, atol=1e-15)
