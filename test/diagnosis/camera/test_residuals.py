"""Camera errors from localisations of a door moved by known amounts, against a pinhole written here."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.camera.causes import camera_causes
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import load_settings
from doormill_ros.measurements.picture_reading import DoorReading, Localisations, localisations_of
from support.diagnoses import diagnose_pictures
from support.pictures.moved_door import EVERY, THICKNESS, WIDTH

STD = np.array([2e-5, 2e-5, 5e-5])
CENTRE = np.array([0.004, -0.006])


def photograph(seed=0, scale=1.0, turn=0.0, tilt=(0.0, 0.0), k1=0.0, drift=(0.0, 0.0, 0.0), dent=0.0):
    """Locate a door at 20 places, three times each, by a camera that is wrong in the ways given.

    The camera sees the door plane through a homography: turned, tilted and scaled, then distorted
    about the optical axis. Its owner believes that none of this is there.
    """
    rng = np.random.default_rng(seed)
    moved = np.repeat(
        np.column_stack([rng.uniform(-0.01, 0.01, (20, 2)), rng.uniform(-0.035, 0.035, 20)]), 3, axis=0
    )
    time = np.arange(len(moved)) * 30.0

    def seen(point):
        p = point - CENTRE
        p = p / (1.0 - p @ np.array(tilt))[:, None]
        p = p * (1.0 + k1 * np.sum(p**2, axis=1))[:, None]
        c, s = np.cos(turn), np.sin(turn)
        return scale * p @ np.array([[c, s], [-s, c]])

    # The owner calibrates so that the door in its nominal place reads zero.
    located = np.column_stack([seen(moved[:, :2]) - seen(np.zeros((1, 2))), moved[:, 2]])
    located += time[:, None] * np.array(drift)
    located[:, 0] += dent * np.sin(900.0 * moved[:, 1])
    located += rng.normal(size=located.shape) * STD
    return Localisations(moved, located, time, STD, CENTRE)


def named(diagnosis):
    return {finding.cause.name for finding in diagnosis.findings}


@pytest.mark.parametrize("seed", range(8))
def test_a_good_camera_is_consistent(seed):
    diagnosis = diagnose_pictures(photograph(seed))
    assert diagnosis.verdict == "consistent"
    assert diagnosis.holdout_rmse[0] == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("wrong", "cause", "truth"),
    [
        ({"scale": 1.02}, "camera_scale", [0.02]),
        ({"turn": 0.015}, "camera_turn", [0.015]),
        ({"tilt": (2.0, -1.0)}, "camera_tilt", None),
        ({"k1": 300.0}, "camera_distortion", None),
        ({"drift": (5e-8, -8e-8, 2e-7)}, "camera_drift", [5e-8, -8e-8, 2e-7]),
    ],
)
def test_one_error_is_named_and_sized(seed, wrong, cause, truth):
    diagnosis = diagnose_pictures(photograph(seed, **wrong))
    assert diagnosis.verdict == "explained"
    assert cause in named(diagnosis)
    before, after = diagnosis.holdout_rmse
    assert after < 1.2 < before
    if truth is not None:
        assert named(diagnosis) == {cause}
        finding = diagnosis.findings[0]
        assert np.all(np.abs(finding.values - truth) < 4.0 * finding.std + 0.02 * np.abs(truth))


def test_two_errors_are_told_apart():
    diagnosis = diagnose_pictures(photograph(5, scale=0.985, drift=(0.0, 6e-8, 0.0)))
    assert named(diagnosis) == {"camera_scale", "camera_drift"}


def test_an_error_without_a_name_is_unexplained():
    diagnosis = diagnose_pictures(photograph(6, dent=1.5e-4))
    assert diagnosis.verdict == "unexplained"
    assert diagnosis.findings == ()


def test_every_camera_cause_tells_its_pattern():
    assert len({cause.name for cause in camera_causes()}) == len(camera_causes()) == 7
    for cause in camera_causes():
        assert len(cause.pattern()) > 25


def believed(photographed, model):
    """Diagnosis when the localizer believes in `model(i)` at picture i."""
    moved, pictures = photographed
    layout, time = load_layout(), EVERY * np.arange(len(pictures))
    known = load_settings().lens_in_question()  # one door: its thickness and the mounting are the same in all
    found = [localize(p, model(i), layout, WIDTH, THICKNESS, settings=known) for i, p in enumerate(pictures)]
    return diagnose_pictures(localisations_of(found, moved, time, model(0), layout, WIDTH, THICKNESS))


def test_the_right_camera_model_is_consistent_on_real_localisations(photographed):
    diagnosis = believed(photographed, lambda i: load_camera())
    assert diagnosis.verdict == "consistent"


def sized(diagnosis, cause):
    """Values and standard deviations of one finding, which stands beside the displaced corner alone."""
    assert diagnosis.verdict == "explained"
    assert named(diagnosis) == {cause, "camera_placing"}
    return next((f.values, f.std) for f in diagnosis.findings if f.cause.name == cause)


def distance():
    """From the projection centre to the face [m]."""
    return load_layout().T_base_door(WIDTH, THICKNESS)[0, 3] - load_camera().position[0]


def test_a_wrong_focal_length_is_a_wrong_scale(photographed):
    # The lens bends rays that are taken for one per cent too steep, by six micrometres at the corner: that belongs
    # to the wrong focal length and is no distortion. The corner is not on the optical axis, so it is displaced, too.
    camera = load_camera()
    k = camera.k * np.array([[1.01, 1.0, 1.0], [1.0, 1.01, 1.0], [1.0, 1.0, 1.0]])
    values, std = sized(believed(photographed, lambda i: replace(camera, k=k)), "camera_scale")
    assert abs(values[0] - (1 / 1.01 - 1)) < 4.0 * std[0] < 1e-4


def test_a_wrong_distance_is_told_from_a_wrong_focal_length(photographed):
    camera = load_camera()
    nearer = replace(camera, position=camera.position + np.array([2e-3, 0.0, 0.0]))
    values, std = sized(believed(photographed, lambda i: nearer), "camera_distance")
    assert abs(values[0] - -2e-3 / distance()) < 4.0 * std[0] < 1e-4


def test_a_small_wrong_scale_may_be_either(photographed):
    camera = load_camera()
    nearer = replace(camera, position=camera.position + np.array([1e-4, 0.0, 0.0]))
    diagnosis = believed(photographed, lambda i: nearer)
    (scale,) = (f for f in diagnosis.findings if f.cause.name != "camera_placing")
    assert {cause.name for cause in (scale.cause, *scale.confusable)} == {"camera_scale", "camera_distance"}


def test_a_wrong_lens_is_a_distortion(photographed):
    camera = load_camera()
    bent = replace(camera, distortion=camera.distortion + 0.004 * np.eye(5)[0])
    values, std = sized(believed(photographed, lambda i: bent), "camera_distortion")
    assert abs(values[0] - -0.004 / distance() ** 2) < 4.0 * std[0] < 0.5 * abs(values[0])


@pytest.mark.parametrize("tilt", [(0.0, 0.002), (0.001, -0.001)])
def test_a_tilted_camera_is_a_tilt(photographed, tilt):
    camera = load_camera()
    tilted = replace(camera, rotation_vector=camera.rotation_vector + np.array([*tilt, 0.0]))
    values, std = sized(believed(photographed, lambda i: tilted), "camera_tilt")
    expected = np.array([-tilt[1], tilt[0]]) / distance()
    assert np.all(np.abs(values - expected) < 4.0 * std)
    assert np.all(4.0 * std < 2e-3)


def test_a_lens_without_distortion_reads_as_a_pinhole():
    """The camera model, made wrong, and the pinhole's formulas say the same of the corner, signs included."""
    camera = replace(load_camera(), distortion=np.zeros(5))
    layout = load_layout()
    rng = np.random.default_rng(4)
    moved = np.column_stack([rng.uniform(-0.01, 0.01, (9, 2)), rng.uniform(-0.03, 0.03, 9)])
    centre = camera.T_base_camera(WIDTH)[1:3, 3] - layout.T_base_door(WIDTH, THICKNESS)[1:3, 3]
    pinhole = Localisations(moved, moved, np.zeros(9), STD, centre)
    known = replace(pinhole, reading=DoorReading(camera, layout, WIDTH, THICKNESS))
    assert {"camera_scale", "camera_turn", "camera_tilt"} <= {cause.name for cause in camera_causes()}
    for cause in camera_causes():
        if cause.name in ("camera_scale", "camera_turn", "camera_tilt"):
            expected = cause.unit(pinhole)[:, :2]
            np.testing.assert_allclose(
                cause.unit(known)[:, :2], expected, atol=2e-3 * np.abs(expected).max(), err_msg=cause.name
            )


def test_a_camera_turned_about_its_axis_is_a_turn(photographed):
    camera = load_camera()
    turned = replace(camera, rotation_vector=camera.rotation_vector + np.array([0.0, 0.0, 0.005]))
    diagnosis = believed(photographed, lambda i: turned)
    values = {f.cause.name: f.values for f in diagnosis.findings}
    assert diagnosis.verdict == "explained"
    assert set(values) == {"camera_turn", "camera_placing"}
    assert abs(values["camera_turn"][0]) == pytest.approx(0.005, rel=0.02)


def test_a_camera_that_creeps_on_its_slider_drifts(photographed):
    camera = load_camera()
    diagnosis = believed(
        photographed, lambda i: replace(camera, position=camera.position + 1e-7 * EVERY * i * np.eye(3)[1])
    )
    assert diagnosis.verdict == "explained"
    assert named(diagnosis) == {"camera_drift"}
    assert diagnosis.findings[0].values[0] == pytest.approx(1e-7, rel=0.03)
