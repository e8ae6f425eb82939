"""Six distance sensors: simulated readings back to the pose, honest covariance, refusals."""

import numpy as np
import pytest
import yaml

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.sensors.errors import BadReading, BadSensorFile, BeamMissed, PoseOutOfRange
from doormill_ros.localization.sensors.photoelectric import load_photoelectric
from doormill_ros.resources import resource
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig
from support.sensors.pose_errors import SIZES, assert_honest, error, mahalanobis, true_pose


@pytest.fixture(scope="module")
def sensor():
    return load_photoelectric()


@pytest.fixture(scope="module")
def rig():
    return PhotoelectricRig.load()


def reading(rig, T_base_door, door, seed):
    return rig.read(T_base_door, door.width, door.height, door.thickness, seed)


def test_covariance_is_honest_for_every_door(sensor, rig):
    squares, rng = [], np.random.default_rng(11)
    for trial in range(300):
        door = SIZES[trial % len(SIZES)]
        T_base_door = true_pose(door, rng)
        estimate = sensor.locate(reading(rig, T_base_door, door, trial), door)
        squares.append(mahalanobis(estimate, T_base_door))
    assert_honest(squares)


def test_without_errors_the_pose_is_exact(sensor, tmp_path):
    document = yaml.safe_load(resource("config/sensors/photoelectric.yaml").read_text(encoding="utf-8"))
    document["sensor"] |= {"resolution": 1e-12, "linearity": 0.0, "noise": 0.0}
    document |= {"surface": 0.0, "mounting_deviation": 0.0}
    path = tmp_path / "exact.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    exact, rng = PhotoelectricRig.load(path), np.random.default_rng(3)
    for door in SIZES:
        T_base_door = true_pose(door, rng)
        miss = error(sensor.locate(reading(exact, T_base_door, door, 5), door), T_base_door)
        # What is left is how well the beams were aimed: 0.2 mrad over 55 mm on a face turned by 2 degrees.
        assert np.abs(miss[:3]).max() < 3e-6
        assert np.abs(miss[3:]).max() < 5e-6


def test_readings_come_in_steps_of_the_resolution(rig):
    door = SIZES[1]
    values = reading(rig, load_layout().T_base_door(door.width, door.thickness), door, 1)
    step = rig.document["sensor"]["resolution"] / rig.document["readings"]
    np.testing.assert_allclose(values / step, np.round(values / step), atol=1e-6)


def test_whole_range_of_the_clamp_is_within_the_sensors_range(sensor, rig):
    """0.40 m between the beams on the hinge edge is the most that 10 mm and 2 degrees allow."""
    for door in SIZES:
        for y in (-0.010, 0.010):
            for rotation in (-0.0349, 0.0349):
                T_base_door = load_layout().T_base_door(
                    door.width, door.thickness, DoorOffset(y, -0.010, rotation)
                )
                assert np.all(np.isfinite(reading(rig, T_base_door, door, 2))), (door, y, rotation)


def test_a_metre_between_the_beams_is_too_much(tmp_path):
    document = yaml.safe_load(resource("config/sensors/photoelectric.yaml").read_text(encoding="utf-8"))
    document["beams"][4]["z"] = 1.0
    path = tmp_path / "wide.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    door = SIZES[1]
    T_base_door = load_layout().T_base_door(door.width, door.thickness, DoorOffset(0.0, 0.0, -0.0349))
    values = reading(PhotoelectricRig.load(path), T_base_door, door, 1)
    with pytest.raises(BeamMissed, match="sensor 5 on the hinge"):
        load_photoelectric(path).locate(values, door)


def test_a_missed_beam_is_named(sensor):
    values = np.full(6, 0.055)
    values[5] = np.nan
    with pytest.raises(BeamMissed, match="sensor 6 on the bottom"):
        sensor.locate(values, SIZES[0])


def test_a_chip_under_a_beam_moves_the_pose_and_nothing_notices(sensor, rig):
    """The price of six readings for six unknowns; docs/sensors.md says so."""
    door = SIZES[1]
    T_base_door = load_layout().T_base_door(door.width, door.thickness)
    values = reading(rig, T_base_door, door, 4)
    values[5] += 0.002
    estimate = sensor.locate(values, door)
    assert estimate.redundancy == 0
    assert mahalanobis(estimate, T_base_door) > 1000


def test_a_pose_that_the_clamp_cannot_hold_is_refused(sensor):
    values = np.full(6, 0.055)
    values[:3] -= 0.010
    with pytest.raises(PoseOutOfRange, match="in x"):
        sensor.locate(values, SIZES[1])


def test_wrong_number_of_distances_is_refused(sensor):
    with pytest.raises(BadReading):
        sensor.locate(np.full(5, 0.055), SIZES[1])


@pytest.mark.parametrize("break_it", [lambda d: d.pop("beams"), lambda d: d["beams"][0].update(face="top")])
def test_a_broken_file_is_refused(break_it, tmp_path):
    document = yaml.safe_load(resource("config/sensors/photoelectric.yaml").read_text(encoding="utf-8"))
    break_it(document)
    path = tmp_path / "broken.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    with pytest.raises(BadSensorFile):
        load_photoelectric(path)
