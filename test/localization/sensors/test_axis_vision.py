"""Three cameras for six degrees of freedom: derivatives, honest covariance on pictures, refusals."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import apply_twist
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.sensors.axis_vision import load_axis_vision
from doormill_ros.localization.sensors.edge_rays import EDGES, depth, miss, seen
from doormill_ros.localization.sensors.errors import BadReading, BadSensorFile, EdgeNotFound, SensorError
from doormill_ros.simulation.picture.scene import Sensor
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from support.sensors.pose_errors import SIZES, assert_honest, error, mahalanobis, true_pose

TRIALS = 18


@pytest.fixture(scope="module")
def sensor():
    return load_axis_vision()


@pytest.fixture(scope="module")
def rig():
    return AxisVisionRig.load()


def pictures(rig, T_base_door, door, seed):
    return rig.take(T_base_door, door.width, door.height, door.thickness, seed)


@pytest.fixture(scope="module")
def nominal(rig):
    door = SIZES[1]
    T_base_door = load_layout().T_base_door(door.width, door.thickness)
    return door, T_base_door, pictures(rig, T_base_door, door, 77)


@pytest.fixture(scope="module")
def trials(sensor, rig):
    """(door, true pose, estimate) of doors anywhere within the clamp's limits."""
    rng, out = np.random.default_rng(31), []
    for trial in range(TRIALS):
        door = SIZES[trial % len(SIZES)]
        T_base_door = true_pose(door, rng)
        out.append((door, T_base_door, sensor.locate(pictures(rig, T_base_door, door, trial), door)))
    return out


@pytest.mark.parametrize("edge", sorted(EDGES))
@pytest.mark.parametrize("name", ["1", "2", "3"])
def test_derivatives_of_the_miss_agree_with_differences(sensor, name, edge):
    rng, door = np.random.default_rng(int(name)), SIZES[1]
    camera = next(c for c in sensor.cameras if c.name == name)
    T_base_camera = apply_twist(camera.T_base_camera(sensor.layout, door), rng.normal(0, 0.01, 6))
    T_base_door, axis = true_pose(door, rng), EDGES[edge]
    rays = rng.uniform(-0.5, 0.5, (7, 2))
    _, by_door, by_camera = miss(T_base_door, T_base_camera, axis, rays)
    step, expected_door, expected_camera = 1e-6, [], []
    for e in step * np.eye(6):
        high, low = (miss(apply_twist(T_base_door, s * e), T_base_camera, axis, rays)[0] for s in (1, -1))
        expected_door.append((high - low) / (2 * step))
        high, low = (miss(T_base_door, apply_twist(T_base_camera, s * e), axis, rays)[0] for s in (1, -1))
        expected_camera.append((high - low) / (2 * step))
    np.testing.assert_allclose(by_door, np.array(expected_door).T, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(by_camera, np.array(expected_camera).T, rtol=1e-5, atol=1e-6)


def test_rays_of_an_edge_do_not_miss_it(sensor):
    door, T_base_door = SIZES[2], true_pose(SIZES[2], np.random.default_rng(4))
    assert len(sensor.cameras) == len(EDGES) == 3
    for camera in sensor.cameras:
        T_base_camera = camera.T_base_camera(sensor.layout, door)
        for axis in EDGES.values():
            rays = seen(T_base_door, T_base_camera, axis, np.linspace(0.0, 0.08, 5))
            np.testing.assert_allclose(miss(T_base_door, T_base_camera, axis, rays)[0], 0.0, atol=1e-12)


def test_camera_1_stands_where_the_single_camera_does(sensor):
    """Same lens and mounting as config/camera.yaml, to a millimetre."""
    camera = load_camera()
    for door in SIZES:
        T_base_camera = sensor.cameras[0].T_base_camera(sensor.layout, door)
        np.testing.assert_allclose(T_base_camera, camera.T_base_camera(door.width), atol=1e-12)
    np.testing.assert_array_equal(sensor.lens.k, camera.k)
    assert depth(load_layout().T_base_door(0.8, 0.05), T_base_camera, 2, np.zeros(1))[0] == pytest.approx(
        0.168
    )


def test_covariance_is_honest_on_pictures(trials):
    assert_honest([mahalanobis(estimate, T_base_door) for _, T_base_door, estimate in trials])


def test_residuals_have_the_size_that_noise_and_roughness_explain(trials):
    total = sum(e.chi_square for *_, e in trials) / sum(e.redundancy for *_, e in trials)
    assert 0.8 < total < 1.2


def test_every_edge_is_found_all_along(trials):
    assert len(trials) == TRIALS
    for door, _, estimate in trials:
        counts = estimate.details["edge_points"]
        assert set(counts) == {"1y", "1z", "2x", "2y", "3x", "3z"}
        assert min(counts.values()) >= min(10, int((door.thickness - 0.012) / 0.002))


def test_without_errors_the_pose_is_right_to_a_micrometre(sensor, rig):
    """Only the rendering's own discretisation is left."""
    document = rig.document | {
        "mounting_deviation": {"position": 0.0, "rotation": 0.0},
        "edges": {"roughness": 0.0, "correlation": 2e-3},
    }
    exact = AxisVisionRig(document, rig.layout, Sensor(blur=1.0, read_noise=0.0, gain=0.0))
    for seed, door in enumerate(SIZES):
        T_base_door = true_pose(door, np.random.default_rng(seed))
        miss_of_it = error(sensor.locate(pictures(exact, T_base_door, door, seed), door), T_base_door)
        assert np.abs(miss_of_it[:3]).max() < 1.5e-6
        assert np.abs(miss_of_it[3:]).max() < 3e-5


def test_cameras_merge_what_they_see_twice(sensor, nominal):
    """y is seen by cameras 1 and 2, z by 1 and 3, x by 2 and 3: all better than one mounting allows."""
    door, _, taken = nominal
    deviations = sensor.locate(taken, door).deviations
    one_mounting = np.hypot(sensor.position_deviation, 0.168 * sensor.rotation_deviation)
    assert np.all(deviations[:3] < one_mounting * 1.05)
    assert np.all(deviations[:3] > 0.5 * one_mounting)


@pytest.mark.parametrize("name", ["1", "2", "3"])
def test_a_dark_picture_is_refused_by_name(sensor, nominal, name):
    door, _, taken = nominal
    noise = np.random.default_rng(1).integers(8, 14, taken[name].shape, dtype=np.uint8)
    with pytest.raises(EdgeNotFound, match=f"camera {name}"):
        sensor.locate(taken | {name: noise}, door)


def test_a_low_contrast_is_refused(sensor, nominal):
    door, _, taken = nominal
    with pytest.raises(EdgeNotFound, match="contrast"):
        sensor.locate(taken | {"2": (taken["2"] // 6).astype(np.uint8)}, door)


def test_exchanged_cameras_are_refused(sensor, nominal):
    door, _, taken = nominal
    with pytest.raises(SensorError):
        sensor.locate({"1": taken["1"], "2": taken["3"], "3": taken["2"]}, door)


def test_a_displaced_camera_contradicts_the_others(sensor, nominal):
    door, _, taken = nominal
    with pytest.raises(SensorError, match="contradict"):
        sensor.locate(taken | {"3": np.roll(taken["3"], 12, axis=0)}, door)


def test_missing_and_wrong_pictures_are_refused(sensor, nominal):
    door, _, taken = nominal
    with pytest.raises(BadReading, match="camera 3"):
        sensor.locate({"1": taken["1"], "2": taken["2"]}, door)
    with pytest.raises(BadReading, match="camera 2"):
        sensor.locate(taken | {"2": taken["2"][:-1]}, door)


def test_a_broken_file_is_refused(tmp_path):
    path = tmp_path / "axis.yaml"
    path.write_text("cameras: [{name: 1, looks_at: top}]\nintrinsics: {}\n", encoding="utf-8")
    with pytest.raises(BadSensorFile, match="top"):
        load_axis_vision(path)
