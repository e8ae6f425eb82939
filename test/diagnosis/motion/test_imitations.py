"""Effects that a spring, a scale or a slow wave would imitate: what they are, or nothing, is said of them."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import law_sections, named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.laws import with_laws
from doormill_ros.measurements.sets.motion_set import read_motion_set
from support.motion_world import DAMPING_RATIO, INERTIA, RATIO, ROTOR, STIFFNESS, Recording, record

#: Encoders and drives of which little is noise.
QUIET = Recording(noise=(2e-6, 5e-7, 2.0))


def diagnosed(folder, seed, joints, hidden=Recording(), **gear):  # noqa: B008
    """The diagnosis with laws, and named causes by name and place."""
    for joint in joints:
        hidden = hidden.with_gear(joint, **gear)
    diagnosis = with_laws(diagnose_motions([read_motion_set(record(folder / "set", hidden, seed))]))
    return diagnosis, {(one.cause, one.where): one for one in named_causes(diagnosis)}


@pytest.mark.parametrize("waves", [13.0, 17.0, 26.0])
def test_waves_between_the_usual_ones_and_those_of_a_fine_scale_are_named(tmp_path, waves):
    diagnosis, named = diagnosed(tmp_path, 1, [1], ruler=(3e-5, 0.4, waves))
    (entry,) = named.values()
    assert (diagnosis.verdict, list(named)) == ("explained", [("joint_periodic_error", "joint 1")])
    found = entry.parameters[f"joint_order_{waves:g}"]
    assert found["value"] == pytest.approx(3e-5, abs=max(4.0 * found["std"], 1e-6))


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("rotor", [0.5, 1.0])
def test_what_speeds_up_the_motor_is_no_spring(tmp_path, seed, rotor):
    diagnosis, named = diagnosed(tmp_path, seed, [1, 2, 3], rotor=rotor)
    assert set(named) == {("motor_inertia", f"joint {joint}") for joint in (1, 2, 3)}
    assert diagnosis.verdict == "explained"
    for joint, one in enumerate(named.values()):
        inertia = one.parameters["inertia"]["value"]
        assert inertia == pytest.approx(rotor * ROTOR[joint] * RATIO[joint] ** 2, rel=0.03)


def test_far_less_than_the_published_inertia_is_told_as_a_law_of_the_acceleration(tmp_path):
    diagnosis, named = diagnosed(tmp_path, 1, [2, 3], rotor=0.1)
    assert named == {}
    assert {law["driver"] for law in law_sections(diagnosis)["unnamed"]} == {"speed"}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_filter_is_late_and_no_spring(tmp_path, seed):
    _, named = diagnosed(tmp_path, seed, [1], filtered=6e-3)
    assert list(named) == [("time_skew", "joint 1")]
    assert named["time_skew", "joint 1"].parameters["skew"]["value"] == pytest.approx(6e-3, rel=0.05)


@pytest.mark.parametrize(("seed", "height"), [(1, 2e-4), (2, 2e-4), (3, 4e-4)])
def test_a_part_of_one_wave_a_turn_is_no_scale(tmp_path, seed, height):
    diagnosis, named = diagnosed(tmp_path, seed, [1], ruler=(height, 0.9, 1.0))
    scale = named.get(("encoder_scale", "joint 1"))
    if scale is not None:
        assert diagnosis.verdict == "explained"
        assert [double.cause.name for double in scale.doubles] == ["joint_periodic_error"]
    assert set(named) <= {("encoder_scale", "joint 1")}


@pytest.mark.parametrize("damper", [1e5, 3e5])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_damper_beside_the_spring_is_named(tmp_path, seed, damper):
    diagnosis, named = diagnosed(tmp_path, seed, [2], QUIET, damper=damper)
    assert (diagnosis.verdict, list(named)) == ("explained", [("spring_damping", "joint 2")])
    found = named["spring_damping", "joint 2"].parameters["damping"]
    # A gear of this world has some of its own.
    own = 2.0 * DAMPING_RATIO * np.sqrt(STIFFNESS[1] * INERTIA[1])
    assert found["value"] == pytest.approx(damper + own, abs=4.0 * found["std"], rel=0.05)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("late", [{"stale": 0.03}, {"stale": 0.01}, {"drive_filter": 0.02}], ids=str)
def test_a_torque_that_is_read_late_is_named(tmp_path, seed, late):
    diagnosis, named = diagnosed(tmp_path, seed, [2], QUIET, **late)
    assert (diagnosis.verdict, list(named)) == ("explained", [("torque_skew", "joint 2")])
    found = named["torque_skew", "joint 2"].parameters["skew"]
    assert found["value"] == pytest.approx(sum(late.values()), abs=2e-3)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_clear_cause_keeps_its_name_beside_a_joint_that_nothing_explains(tmp_path, seed):
    hidden = Recording().with_gear(1, ruler=(6e-5, 0.4, 13.0)).with_gear(3, crosstalk=2e-3)
    diagnosis, named = diagnosed(tmp_path, seed, [], hidden)
    assert (diagnosis.verdict, list(named)) == ("partly_explained", [("joint_periodic_error", "joint 1")])
    assert {law["where"] for law in law_sections(diagnosis)["unnamed"]} == {"joint 3"}
