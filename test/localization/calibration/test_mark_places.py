"""A calibrated camera puts the marks where they are; from then on they tell whether it still stands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.marks.drift import drift_in
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera
from doormill_ros.tools import calibrate
from support.pictures.marked_cell import marked_camera_file

WIDTH, THICKNESS = 0.826, 0.040


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> SceneCamera:
    """Marks that stand up to 1.5 mm from where the file has them."""
    camera = SceneCamera.load(marked_camera_file(tmp_path_factory.mktemp("world")))
    rng = np.random.default_rng(12)
    places = tuple(tuple(np.array(p) + rng.uniform(-1.0, 1.0, 2) * 1.5e-3) for p in camera.marks.places)
    return replace(camera, marks=replace(camera.marks, places=places))


@pytest.fixture(scope="module")
def pictures(world: SceneCamera) -> list[np.ndarray]:
    scene = PictureScene(width=WIDTH, thickness=THICKNESS, camera=world)
    return [render_picture(scene, seed) for seed in range(3)]


def written(pictures: list[np.ndarray], folder: Path) -> list[str]:
    paths = [folder / f"{i}.png" for i in range(len(pictures))]
    for path, picture in zip(paths, pictures, strict=True):
        cv2.imwrite(str(path), picture)
    return [str(path) for path in paths]


def test_the_marks_are_put_where_they_are(
    world: SceneCamera, pictures: list[np.ndarray], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rough, out = marked_camera_file(tmp_path), tmp_path / "marked.yaml"
    command = ["marks", *written(pictures[:2], tmp_path)]
    assert calibrate.main([*command, "--camera", str(rough), "--out", str(out)]) == 0
    assert "mark 13: y = " in capsys.readouterr().out
    corner = load_layout().T_base_door(WIDTH, THICKNESS)[:3, 3]
    found = load_camera(out)
    apart = np.linalg.norm(np.array(found.marks.places) - np.array(world.marks.places), axis=1)
    assert np.sqrt(np.mean(apart**2)) < 2.0 * found.marks.deviation < 1e-5
    drift = drift_in(pictures[2], found, WIDTH, corner)
    assert drift.sentence == "the camera has not moved"
    assert drift.share < 0.2


def test_a_mark_that_is_not_seen_is_named(
    pictures: list[np.ndarray], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rough = marked_camera_file(tmp_path)
    hidden = pictures[0].copy()
    hidden[:200] = 40
    for sent, says in (
        ([pictures[0], hidden], "of 13 is seen in 1 of 2 pictures"),
        ([pictures[0][:500]], "1920 x 500 px"),
    ):
        command = ["marks", *written(sent, tmp_path), "--camera", str(rough)]
        assert calibrate.main([*command, "--out", str(tmp_path / "out.yaml")]) == 2
        assert says in capsys.readouterr().err
    command = ["marks", *written(pictures, tmp_path), "--out", str(tmp_path / "out.yaml")]
    assert calibrate.main(command) == 2
    assert "has no marks" in capsys.readouterr().err
    assert not (tmp_path / "out.yaml").exists()
