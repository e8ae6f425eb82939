"""The mounting from a door moved by known steps; the thesis' scale beside it."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import apply_twist, transform, twist_between
from doormill_ros.localization.calibration.errors import PoorlySpread, TooFewPictures
from doormill_ros.localization.calibration.extrinsics import Knowledge, MovedDoor, calibrate_extrinsics
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.sensors.corner_edges import PictureQuality
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from support.sensors.pose_errors import assert_honest

QUALITY = PictureQuality(2.0, 25.0)
KNOWN = Knowledge(thickness=0.0)  # the doors of these pictures are exactly as thick as said
SEEDS = 4
MOVES = [
    (0.04, (0, 0, 0)),
    (0.04, (0, 0.01, 0)),
    (0.04, (0, 0, 0.01)),
    (0.1, (0, 0, 0)),
    (0.1, (0, 0.01, 0.01)),
]


@pytest.fixture(scope="module")
def rig():
    """The face camera alone, put up carelessly: a millimetre and a quarter of a degree off."""
    document = AxisVisionRig.load(resource("config/sensors/axis_vision.yaml")).document
    document |= {
        "cameras": document["cameras"][:1],
        "mounting_deviation": {"position": 0.001, "rotation": 0.004},
    }
    return AxisVisionRig(document, load_layout())


def moved_doors(rig, seed):
    """Pictures of a door whose place, turn and moves are as uncertain as `Knowledge` says."""
    rng, known, out = np.random.default_rng([seed, 9]), Knowledge(), []
    misplaced = rng.normal(0, np.repeat([known.place, known.turn], 3))
    for number, (thickness, move) in enumerate(MOVES):
        door = DoorSize(width=0.826, height=2.04, thickness=thickness)
        T_base_door = load_layout().T_base_door(door.width, thickness)
        T_base_door = apply_twist(T_base_door, misplaced)
        T_base_door[:3, 3] += np.array(move) + rng.normal(0, known.move, 3) * np.any(move)
        # Each thickness is another door with edges of its own; the camera stays.
        taken = rig.take(
            T_base_door, door.width, door.height, thickness, seed=1000 * seed + number, rig_seed=seed
        )
        out.append(MovedDoor(taken["1"], np.array(move, dtype=float), door))
    return out


@pytest.fixture(scope="module")
def calibrations(rig):
    """(found, true T_base_camera at a width of zero)."""
    out = []
    for seed in range(SEEDS):
        centre, axes = rig.stand(0, 0.826, 0.04, seed)
        true = transform(axes, centre + np.array([0.0, 0.826 / 2, 0.0]))
        out.append(
            (
                calibrate_extrinsics(moved_doors(rig, seed), load_camera(), load_layout(), QUALITY, KNOWN),
                true,
            )
        )
    assert len(out) == SEEDS
    return out


def test_the_mounting_comes_back_with_an_honest_covariance(calibrations):
    squares = []
    for found, true in calibrations:
        miss = twist_between(found.camera.T_base_camera(0.0), true)
        squares.append(float(miss @ np.linalg.solve(found.covariance, miss)))
        before = twist_between(load_camera().T_base_camera(0.0), true)
        assert np.linalg.norm(miss[:3]) < 0.1 * np.linalg.norm(before[:3])
    assert_honest(squares)


def test_what_remains_in_the_pose_of_a_door_is_hundredths_of_a_millimetre(calibrations):
    """Place and turn of the camera trade against each other; the door's pose hardly notices."""
    assert len(calibrations) == SEEDS
    for found, _ in calibrations:
        assert set(found.door_deviation) == {0.03, 0.04, 0.1}
        assert found.thicknesses == (0.04, 0.1)
        assert not found.needs_a_thick_door
        for y, z, rotation in found.door_deviation.values():
            assert max(y, z) < 2e-5
            assert rotation < 2e-4
        assert np.sqrt(np.diag(found.covariance))[:3].max() > 2e-5


def test_the_thesis_scale_is_that_of_the_camera_at_that_thickness(calibrations):
    assert len(calibrations) == SEEDS
    for found, true in calibrations:
        assert len(found.scale) == 2
        for thesis, model in zip(found.scale, found.model_scale, strict=True):
            assert thesis == pytest.approx(model, rel=3e-3)
        # fx and fy of eq. 3.43 differ, so the two scales do: the thesis expects them alike.
        assert found.scale[0] / found.scale[1] == pytest.approx(1727.22 / 1678.35, rel=0.01)
        distance = load_layout().rear_face_x - 0.040 - true[0, 3]
        assert found.scale[0] == pytest.approx(distance / 1678.35, rel=0.02)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_lens_that_is_off_is_in_what_is_stated_without_a_thick_door(rig, sign):
    """Four pictures of one door by a camera whose focal length is 0.1 % off, and said to be so uncertain."""
    share, seed = 1e-3, 5
    lens, k = np.zeros(9), np.array(rig.document["intrinsics"]["k"])
    lens[:2] = share * k[[0, 1], [0, 1]]
    k[[0, 1], [0, 1]] *= 1.0 + sign * share
    intrinsics = rig.document["intrinsics"] | {"k": k.tolist()}
    other = AxisVisionRig(rig.document | {"intrinsics": intrinsics}, load_layout())
    moved = [m for m in moved_doors(other, seed) if m.door.thickness < 0.05]
    centre, axes = other.stand(0, 0.826, 0.04, seed)
    true = transform(axes, centre + np.array([0.0, 0.826 / 2, 0.0]))
    assert len(moved) == 3
    known = Knowledge(thickness=0.0, lens=np.outer(lens, lens))
    sure, honest = (
        calibrate_extrinsics(moved, load_camera(), load_layout(), QUALITY, knowledge)
        for knowledge in (KNOWN, known)
    )
    assert honest.needs_a_thick_door
    misses = [twist_between(f.camera.T_base_camera(0.0), true)[0] for f in (sure, honest)]
    deviations = [float(np.sqrt(f.covariance[0, 0])) for f in (sure, honest)]
    assert abs(misses[1]) < 2.5 * deviations[1]
    assert deviations[1] > 1.5e-4 > 2 * deviations[0]  # 0.1 % of the 0.168 m to the door
    # The doors of the pictures hardly notice, one of another thickness does.
    assert max(honest.door_deviation[0.04][:2]) < 2.5e-5
    assert np.all(honest.door_deviation[0.1][:2] > 1.04 * sure.door_deviation[0.1][:2])


def test_a_wrong_move_in_the_list_is_noticed(rig):
    moved = moved_doors(rig, 1)
    moved[1] = MovedDoor(moved[1].picture, np.array([0.0, 0.009, 0.0]), moved[1].door)
    with pytest.raises(PoorlySpread, match="list of moves"):
        calibrate_extrinsics(moved, load_camera(), load_layout(), QUALITY)


def test_two_pictures_are_too_few(rig):
    empty = MovedDoor(
        np.zeros((1080, 1920), np.uint8), np.zeros(3), DoorSize(width=0.8, height=2.0, thickness=0.04)
    )
    with pytest.raises(TooFewPictures, match="2 pictures"):
        calibrate_extrinsics([empty, empty], load_camera(), load_layout(), QUALITY)


@pytest.fixture(scope="module")
def clean(rig):
    """Pictures of seed 1, all moves as the list says."""
    return moved_doors(rig, 1)


@pytest.mark.parametrize("off", [-1e-4, 1e-4])
@pytest.mark.parametrize(("number", "axis"), [(1, 1), (2, 2)])
def test_a_move_that_is_wrong_by_a_tenth_of_a_millimetre_is_told_with_its_picture(clean, number, axis, off):
    moved = list(clean)
    listed = moved[number].move.copy()
    listed[axis] -= off
    moved[number] = MovedDoor(moved[number].picture, listed, moved[number].door)
    with pytest.raises(
        PoorlySpread, match=rf"^picture {number + 1}, .* along {'xyz'[axis]} from there"
    ) as told:
        calibrate_extrinsics(moved, load_camera(), load_layout(), QUALITY, KNOWN)
    size = float(told.value.message.split("shows its door ")[1].split(" mm")[0])
    assert size == pytest.approx(1e3 * off, abs=0.04)


def test_the_mounting_fits_the_lens_of_the_file_whatever_its_doubt(clean):
    """It goes beside that lens: one that fits a lens corrected along with it would put doors elsewhere."""
    lens = np.zeros(9)
    lens[:2] = 1e-3 * load_camera().k[[0, 1], [0, 1]]
    doubted = Knowledge(thickness=0.0, lens=np.outer(lens, lens))
    sure, honest = (
        calibrate_extrinsics(clean, load_camera(), load_layout(), QUALITY, known)
        for known in (KNOWN, doubted)
    )
    np.testing.assert_allclose(honest.camera.position, sure.camera.position, atol=1e-8)
    np.testing.assert_allclose(honest.camera.rotation_vector, sure.camera.rotation_vector, atol=1e-8)
    assert np.all(np.diag(honest.covariance) >= np.diag(sure.covariance))
    assert honest.covariance[0, 0] > 1.5 * sure.covariance[0, 0]
