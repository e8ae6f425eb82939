"""The camera file of a cell with marks: a column beside the hinge edge and a row below the bottom edge."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.simulation.picture.scene import SceneCamera
from support.source_tree import ROOT

MARKS = """
marks:
  x: 1.925
  radius: 2.0e-3
  deviation: 4.0e-6
  limit: [5.0e-5, 5.0e-5, 2.0e-4]
  places: [[0.268, -0.178], [0.268, -0.161], [0.268, -0.144], [0.268, -0.127], [0.268, -0.110], [0.268, -0.093],
           [0.268, -0.076], [0.300, -0.190], [0.335, -0.190], [0.370, -0.190], [0.405, -0.190], [0.440, -0.190],
           [0.475, -0.190]]
"""


def marked_camera_file(folder: Path, marks: str = MARKS) -> Path:
    """config/camera.yaml with marks."""
    path = folder / "camera.yaml"
    path.write_text((ROOT / "config" / "camera.yaml").read_text(encoding="utf-8") + marks)
    return path


@cache
def marked_cameras() -> tuple[SceneCamera, CameraModel]:
    """The true camera of such a cell, and what the localizer knows of it."""
    with tempfile.TemporaryDirectory() as folder:
        path = marked_camera_file(Path(folder))
        return SceneCamera.load(path), load_camera(path)
