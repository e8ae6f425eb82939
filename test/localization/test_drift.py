"""A camera that is not where it was calibrated is told by the cell's marks, with the size of what happened to it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.errors import BadCameraFile, CameraMoved, LocalizationError, MarksMissing
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.marks.drift import Drift, drift_in
from doormill_ros.localization.marks.mark_watch import MarkWatch
from doormill_ros.localization.result import Localization
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Blot, PictureScene, SceneCamera
from support.pictures.corpus import workshop_scene
from support.pictures.marked_cell import MARKS, marked_camera_file

WIDTH, THICKNESS = 0.826, 0.040
LAYOUT = load_layout()
OFFSET = DoorOffset(0.003, -0.002, 0.01)
Move = Callable[[SceneCamera], SceneCamera]


class Cell:
    """A camera with marks, the same without, and the world that both look at."""

    def __init__(self, folder: Path) -> None:
        path = marked_camera_file(folder)
        self.marked, self.plain = load_camera(path), load_camera()
        self.world = SceneCamera.load(path)

    def picture(
        self, camera: SceneCamera, thickness: float = THICKNESS, seed: int = 5, **scene: object
    ) -> np.ndarray:
        return render_picture(
            PictureScene(width=WIDTH, thickness=thickness, offset=OFFSET, camera=camera, **scene), seed
        )

    def drift(self, picture: np.ndarray, thickness: float = THICKNESS) -> Drift | None:
        return drift_in(picture, self.marked, WIDTH, LAYOUT.T_base_door(WIDTH, thickness)[:3, 3])


def find(picture: np.ndarray, camera: CameraModel) -> Localization:
    return localize(picture, camera, LAYOUT, WIDTH, THICKNESS)


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Cell:
    return Cell(tmp_path_factory.mktemp("cell"))


def shifted(*way: float) -> Move:
    return lambda camera: replace(camera, origin=camera.origin + np.array(way))


def turned(axis: int, degrees: float) -> Move:
    turn = Rotation.from_rotvec(np.deg2rad(degrees) * np.eye(3)[axis]).as_matrix()
    return lambda camera: replace(camera, turn=turn)


def zoomed(factor: float) -> Move:
    return lambda camera: replace(camera, matrix=camera.matrix * [[factor, 1, 1], [1, factor, 1], [1, 1, 1]])


def turned_and_moved(camera: SceneCamera) -> SceneCamera:
    return turned(2, 0.1)(shifted(0.0, 0.0, 3e-4)(camera))


def errors_of(found: Localization) -> np.ndarray:
    offset = found.offset
    return np.array([offset.y - OFFSET.y, offset.z - OFFSET.z, offset.rotation - OFFSET.rotation])


@pytest.mark.parametrize(
    ("move", "says"),
    [
        (shifted(0.0, 3e-4, 0.0), "the camera has moved by 0.30 mm;"),
        (shifted(0.0, -1.5e-4, 2.6e-4), "the camera has moved by 0.30 mm;"),
        (turned(0, 0.1), "the camera has turned by 0.10 degrees;"),
        (turned(1, -0.1), "the camera has turned by 0.10 degrees;"),
        (turned(2, 0.08), "the camera has turned by 0.08 degrees;"),
        (zoomed(1.003), "the camera's pictures have grown by 0.30 %"),
        (zoomed(0.997), "the camera's pictures have shrunk by 0.30 %"),
        (shifted(5e-4, 0.0, 0.0), r"0\.(49|50) mm nearer"),
        (turned_and_moved, r"moved by 0\.3[01] mm and turned by 0\.10 degrees"),
    ],
)  # fmt: skip
def test_a_camera_that_moved_is_refused_with_how_far(cell: Cell, move: Move, says: str) -> None:
    """Without marks the same picture is accepted and wrong, by as much as the marks say."""
    picture = cell.picture(move(cell.world))
    wrong = errors_of(find(picture, cell.plain))
    assert np.hypot(*wrong[:2]) > 5e-5 or abs(wrong[2]) > 2e-4
    with pytest.raises(CameraMoved) as refused:
        find(picture, cell.marked)
    assert re.search(says, refused.value.message)
    assert "run calibrate" in refused.value.message
    # A way and a turn that do nearly the same are told apart to 0.02 mm; what they do to a door is not at stake.
    drift = refused.value.data["drift"]
    # A way along x is taken for another focal length, which does a little less to a door nearer than the marks.
    assert np.abs(drift.door[:2] - wrong[:2]).max() < (2e-5 if "nearer" in says else 1.2e-5)
    assert abs(drift.door[2] - wrong[2]) < 5e-5


def test_a_small_drift_is_told_and_goes_into_the_covariance(cell: Cell) -> None:
    picture = cell.picture(shifted(0.0, 4e-5, 0.0)(cell.world))
    found, blind = find(picture, cell.marked), find(picture, cell.plain)
    assert found.offset == blind.offset
    assert "moved by 0.04 mm" in found.drift.sentence
    more = found.covariance - blind.covariance
    assert np.sqrt(more[0, 0]) == pytest.approx(4e-5, abs=5e-6)
    assert blind.drift is None


def test_a_camera_that_was_knocked_is_refused(cell: Cell) -> None:
    with pytest.raises(MarksMissing, match="0 of 13 marks"):
        find(cell.picture(shifted(0.0, 0.02, 0.0)(cell.world)), cell.marked)


@pytest.mark.parametrize("seed", range(10))
def test_there_is_no_false_alarm_in_the_workshop(cell: Cell, seed: int) -> None:
    """Ten of a campaign; a marked picture gives the very pose of one that is not looked at for marks."""
    rng = np.random.default_rng([31, seed])
    scene = workshop_scene(rng, cell.world, LAYOUT)
    picture = render_picture(scene, seed)
    drift = drift_in(
        picture, cell.marked, scene.width, LAYOUT.T_base_door(scene.width, scene.thickness)[:3, 3]
    )
    assert drift.share < 0.5
    assert drift.sentence == "the camera has not moved"
    answers = []
    for camera in (cell.marked, cell.plain):
        try:
            answers.append(localize(picture, camera, LAYOUT, scene.width, scene.thickness).offset)
        except LocalizationError as reason:
            answers.append(reason.message)
    assert answers[0] == answers[1]


def test_marks_that_are_hidden_or_loose_count_no_more(cell: Cell) -> None:
    hidden = Blot(np.array([[-0.06, -0.05], [-0.03, -0.05], [-0.03, 0.02], [-0.06, 0.02]]), 0.5)
    drift = cell.drift(cell.picture(cell.world, blots=(hidden,)))
    assert 8 <= drift.seen < 13
    assert drift.share < 0.5
    marks = cell.world.marks
    loose = ((marks.places[0][0] + 4e-4, marks.places[0][1]), *marks.places[1:])
    drift = cell.drift(cell.picture(replace(cell.world, marks=replace(marks, places=loose))))
    assert drift.seen == 12
    assert drift.share < 0.5


def test_marks_on_one_side_do_not_do(cell: Cell) -> None:
    """A column alone does not tell a turn about z from a way along y."""
    column = replace(cell.marked, marks=replace(cell.marked.marks, places=cell.marked.marks.places[:7]))
    with pytest.raises(MarksMissing, match="two sides"):
        drift_in(cell.picture(cell.world), column, WIDTH, LAYOUT.T_base_door(WIDTH, THICKNESS)[:3, 3])


def test_the_thickest_door_leaves_enough_to_see(cell: Cell) -> None:
    assert cell.drift(cell.picture(cell.world, thickness=0.1), thickness=0.1).share < 0.5
    moved = cell.picture(shifted(0.0, 3e-4, 0.0)(cell.world), thickness=0.1)
    with pytest.raises(CameraMoved, match=r"moved by 0.30 mm"):
        cell.drift(moved, thickness=0.1)


def test_since_when_it_is_not_where_it_was(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    stands = cell.drift(cell.picture(cell.world))
    moved = replace(stands, moved=np.array([0.0, 3e-4, 0.0]), door=np.array([-3e-4, 0.0, 0.0]))
    monkeypatch.setenv("TZ", "UTC")
    watch = MarkWatch()
    assert watch.told(moved, 0.0) == "the camera has moved by 0.30 mm since it was calibrated"
    assert watch.told(stands, 14 * 3600 + 5 * 60) == ""
    for _ in range(2):
        assert watch.told(moved, 15 * 3600).startswith("the camera has moved by 0.30 mm since ")
    stood = watch.told(moved, 16 * 3600)[-5:]
    assert stood[2:] == ":05"


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("x: 1.925\n  radius", "x: 1.2\n  radius", "beyond the camera's 1.707 m"),
        ("radius: 2.0e-3", "radius: 0.0", "marks.radius"),
        ("limit: [5.0e-5, 5.0e-5, 2.0e-4]", "limit: [5.0e-5]", "marks.limit"),
        ("[0.268, -0.178]", "[0.268]", "marks.places"),
        ("deviation: 4.0e-6", "deviations: 4.0e-6", "marks"),
    ],
)
def test_marks_that_cannot_be_are_refused(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert old in MARKS
    with pytest.raises(BadCameraFile, match=says):
        load_camera(marked_camera_file(tmp_path, MARKS.replace(old, new)))
