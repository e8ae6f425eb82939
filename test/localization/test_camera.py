"""The camera model against OpenCV's projection, the layout and the simulator's own lens."""

import ast
import copy
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.localization.settings import load_settings
from doormill_ros.localization.view import HINGE, FaceView
from doormill_ros.resources import resource
from doormill_ros.simulation.picture.optics import rays
from doormill_ros.simulation.picture.scene import SceneCamera
from doormill_ros.units import DEG, MM

CORNERS_MM_DEG = [(y, z, r) for y in (-10, 10) for z in (-10, 10) for r in (-2, 0, 2)]


def test_projection_agrees_with_opencv(camera):
    points = np.random.default_rng(1).uniform([1.55, -0.1, -0.2], [1.65, 0.1, 0.0], (50, 3))
    T_base_camera = camera.T_base_camera(0.8)
    R_camera_base = T_base_camera[:3, :3].T
    rotation = cv2.Rodrigues(R_camera_base)[0]
    shift = -R_camera_base @ T_base_camera[:3, 3]
    expected = cv2.projectPoints(points, rotation, shift, camera.k, camera.distortion)[0][:, 0]
    np.testing.assert_allclose(camera.project(points, 0.8), expected, atol=1e-6)


@settings(max_examples=50, deadline=None)
@given(st.floats(0, 1919), st.floats(0, 1079))
def test_undistortion_undoes_distortion(u, v):
    camera = load_camera()
    np.testing.assert_allclose(camera.distort(camera.undistort(np.array([[u, v]]))), [[u, v]], atol=2e-3)


def test_simulator_and_model_see_the_same_lens(camera):
    ray_x, ray_y = rays(SceneCamera.load(), (0, 1080, 0, 1920), 1)
    v, u = np.mgrid[0:1080:90, 0:1920:120]
    seen = camera.distort(np.stack([ray_x[v, u], ray_y[v, u]], axis=-1).astype(float))
    np.testing.assert_allclose(seen, np.stack([u, v], axis=-1), atol=1e-3)


def test_axes_are_those_of_the_optical_frame(camera):
    rotation = camera.T_base_camera(0.9)[:3, :3]
    np.testing.assert_allclose(rotation @ [0, 0, 1], [1, 0, 0])  # z into the picture is base x
    np.testing.assert_allclose(rotation @ [1, 0, 0], [0, -1, 0])  # x right is -y
    np.testing.assert_allclose(rotation @ [0, 1, 0], [0, 0, -1])  # y down is -z


def test_slider_keeps_the_nominal_corner_in_place(camera, layout):
    seen = [camera.project(layout.T_base_door(w, 0.05)[:3, 3], w) for w in (0.19, 0.8, 1.35)]
    np.testing.assert_allclose(seen, np.broadcast_to(seen[0], (3, 2)), atol=1e-9)


def test_scale_of_a_50_mm_door_is_the_thesis_tenth_of_a_millimetre(camera, layout):
    assert FaceView(camera, layout, 0.8, 0.05).pixel == pytest.approx(0.1 * MM, rel=0.02)


@pytest.mark.parametrize("thickness", [0.030, 0.050, 0.100])
def test_corner_and_long_edges_stay_in_view(thickness, camera, layout):
    view = FaceView(camera, layout, 0.8, thickness)
    for y, z, r in CORNERS_MM_DEG:
        pose = np.array([y * MM, z * MM, r * DEG])
        u, v = view.pixels(pose[:2])
        assert 900 < u < 1920 - 60, (y, z, r)
        assert 500 < v < 1080 - 30, (y, z, r)
        along = np.linspace(0, 0.15, 600)
        for edge, least in ((HINGE, 45 * MM), ("bottom", 75 * MM)):
            seen = view.pixels(view.line(edge, pose, along))
            visible = np.all((seen >= 0) & (seen <= [1919, 1079]), axis=1)
            assert along[visible].max() > least, (edge, y, z, r)


def test_face_points_return_from_their_pixels(camera, layout):
    view = FaceView(camera, layout, 1.1, 0.07)
    points = np.random.default_rng(2).uniform([-0.01, -0.01], [0.09, 0.06], (40, 2))
    np.testing.assert_allclose(view.points(view.pixels(points)), points, atol=2e-7)
    base = layout.T_base_door(1.1, 0.07, DoorOffset(0.003, 0.002, 0.0))[:3, 3]
    np.testing.assert_allclose(view.pixels(np.array([0.003, 0.002])), camera.project(base, 1.1), atol=1e-9)


SHIPPED = yaml.safe_load(resource("config/camera.yaml").read_text(encoding="utf-8"))


def changed(path, value, folder):
    """A camera file that differs from the shipped one at one place."""
    document = node = copy.deepcopy(SHIPPED)
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    file = folder / "camera.yaml"
    file.write_text(yaml.safe_dump(document), encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("intrinsics", "k"), [[1, 0], [0, 1]]),
        (("intrinsics", "k"), [[-5.0, 0, 9], [0, 5, 9], [0, 0, 1]]),
        (("distortion", "coefficients"), [0.1, 0.2]),
        (("mounting",), {}),
        (("localizer",), {"max_age": 2.0}),
        (("localizer", "max_blur"), -1.0),
        (("localizer", "max_deviation"), [1.0]),
        (("localizer", "min_inlier_share"), 1.0),
        (("localizer", "min_inlier_share"), 50),
    ],
)
def test_a_broken_camera_file_is_refused(path, value, tmp_path):
    file = changed(path, value, tmp_path)
    with pytest.raises(BadCameraFile):
        (load_settings if path[0] == "localizer" else load_camera)(file)


def _numbers(node, path=()):
    """Where a document has numbers."""
    if isinstance(node, dict | list):
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            yield from _numbers(value, (*path, key))
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield path


@pytest.mark.parametrize("value", [1e300, -1e300, 10**400])
@pytest.mark.parametrize("path", list(_numbers(SHIPPED)), ids=lambda path: ".".join(map(str, path)))
def test_a_number_out_of_this_world_is_refused(path, value, tmp_path):
    file = changed(path, value, tmp_path)
    with pytest.raises(BadCameraFile) as refused:
        (load_settings if path[0] == "localizer" else load_camera)(file)
    assert str(file) in refused.value.message


def test_a_lens_that_looks_past_its_picture_is_refused(tmp_path):
    file = changed(("intrinsics", "k", 0, 2), 1921.0, tmp_path)
    with pytest.raises(BadCameraFile, match="a centre inside the picture"):
        load_camera(file)


def test_simulator_and_localiser_share_no_code():
    root = Path(__file__).resolve().parents[2] / "doormill_ros"
    for folder, pattern, foreign in (
        ("simulation/picture", "*.py", "doormill_ros.localization"),
        ("localization", "*.py", "doormill_ros.simulation"),
    ):
        files = sorted((root / folder).glob(pattern))
        assert len(files) >= 6
        for file in files:
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                names += [a.name for a in node.names] if isinstance(node, ast.Import) else []
                assert not any(name.startswith(foreign) for name in names), file
