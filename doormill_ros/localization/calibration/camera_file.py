"""Write what a calibration found into a file of the form of config/camera.yaml."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic_core import PydanticCustomError

from doormill_ros import config
from doormill_ros.arrays import FloatArray
from doormill_ros.files import write_atomically
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.extrinsics import Extrinsics
from doormill_ros.localization.calibration.intrinsics import Intrinsics
from doormill_ros.localization.calibration.kept import keep
from doormill_ros.localization.calibration.mark_places import MarkPlaces
from doormill_ros.localization.calibration.ros_file import RosIntrinsics
from doormill_ros.localization.camera import CameraModel, camera_of
from doormill_ros.localization.empty_clamp.empty_clamp import SAME_WIDTH, EmptyClampEntry
from doormill_ros.localization.settings import LocalizerSettings, settings_of, shipped_settings
from doormill_ros.values import Array
from doormill_ros.yaml_text import parse

_ROUNDING = 1e-9  # of the largest variance, px^2
_LARGEST = 1e6  # px^2


def read_document(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file, with whole paths of the pictures that it names.

    Raises:
        BadCalibrationFile: There is no such file or no mapping in it.
    """
    document = config.read_document(path, BadCalibrationFile, "see docs/calibration.md")
    if not isinstance(document, dict):
        raise BadCalibrationFile(f"{path} holds no mapping; see docs/calibration.md", path=str(path))
    return _with_paths(document, lambda picture: str((path.parent / picture).absolute()))


def _with_paths(document: dict[str, Any], changed: Callable[[str], str]) -> dict[str, Any]:
    """The document with the paths of its pictures changed; whatever is no list of them is left for `load_camera`."""
    entries = document.get("empty_clamp")
    if not isinstance(entries, list) or not all(isinstance(e, dict) and "picture" in e for e in entries):
        return document
    return document | {"empty_clamp": [e | {"picture": changed(str(e["picture"]))} for e in entries]}


def with_intrinsics(document: dict[str, Any], found: Intrinsics, names: list[str]) -> dict[str, Any]:
    """A camera document with the intrinsics replaced, their deviation told to the localizer.

    Args:
        document: The file to start from.
        found: The calibration.
        names: Those of its pictures, in its order.
    """
    shares = found.k_deviation[:2] / found.k[[0, 1], [0, 1]]
    return _with_lens_deviation(document, float(shares.max())) | {
        "size": list(found.size),
        "intrinsics": {"measured": True, "k": _plain(found.k), "deviation": _plain(found.k_deviation)},
        "distortion": {
            "measured": True,
            "coefficients": _plain(found.distortion),
            "deviation": _plain(found.distortion_deviation),
            "covered": float(found.covered),
        },
        "chessboard": {
            "error": float(found.error),
            "picture_error": {
                name: None if np.isnan(error) else float(error)
                for name, error in zip(names, found.picture_error, strict=True)
            },
            "rejected": [name for name, use in zip(names, found.used, strict=True) if not use],
            "covariance": _plain(found.covariance),
            "board": {
                "stretch": found.shape.stretch,
                "stretch_deviation": found.shape.stretch_deviation,
                "bow": found.shape.bow,
                "bow_deviation": found.shape.bow_deviation,
            },
        },
    }


def with_ros_intrinsics(document: dict[str, Any], found: RosIntrinsics) -> dict[str, Any]:
    """A camera document with the intrinsics of a ROS file, which does not say how sure they are.

    What a calibration of ours said of another lens does not hold for this one: it is at least as unsure as the shipped.
    """
    own = settings_of(document, "the camera file").lens_deviation if "localizer" in document else 0.0
    unsure = max(own, shipped_settings().lens_deviation)
    changed = _with_lens_deviation(document, unsure) | {
        "size": list(found.size),
        "intrinsics": {"measured": True, "k": _plain(found.k)},
        "distortion": {"measured": True, "coefficients": _plain(found.distortion)},
    }
    changed.pop("chessboard", None)
    return changed


def _with_lens_deviation(document: dict[str, Any], share: float) -> dict[str, Any]:
    if not isinstance(document.get("localizer"), dict):
        return document
    return document | {"localizer": document["localizer"] | {"lens_deviation": share}}


def lens_covariance(document: dict[str, Any], camera: CameraModel, settings: LocalizerSettings) -> FloatArray:
    """Covariance of fx, fy, cx, cy [px] and the five distortion coefficients, shape (9, 9).

    Without a calibration of ours it is a focal length off by the localiser's `lens_deviation`, alike along both axes.

    Args:
        document: That of the camera file.
        camera: The same, read.
        settings: Of the same file.

    Raises:
        BadCalibrationFile: `chessboard.covariance` is none.
    """
    chessboard = document.get("chessboard")
    given = chessboard.get("covariance") if isinstance(chessboard, dict) else chessboard
    if given is None:
        off = np.zeros(9)
        off[:2] = settings.lens_deviation * camera.k[[0, 1], [0, 1]]
        return np.outer(off, off)
    try:
        covariance: FloatArray = Array((9, 9)).check(given)
        variances = np.linalg.eigvalsh(covariance)
    except (PydanticCustomError, np.linalg.LinAlgError):
        covariance, variances = np.zeros((9, 9)), np.array([-1.0])
    # Rounding leaves next to nothing below zero; coefficients that were held have exactly nothing.
    if not (
        np.allclose(covariance, covariance.T) and variances[0] >= -_ROUNDING * min(variances[-1], _LARGEST)
    ):
        raise BadCalibrationFile(
            "chessboard.covariance of the camera file is no covariance, allowed is what calibrate intrinsics writes "
            "there, 9 x 9 numbers; calibrate the lens again, or remove the section chessboard"
        )
    return covariance


def with_mounting(document: dict[str, Any], found: Extrinsics) -> dict[str, Any]:
    """A camera document with the mounting replaced, and what it leaves open told to the localiser.

    The localiser takes the worst of the thicknesses, since it does not know the covariance.
    """
    deviation = np.sqrt(np.diag(found.covariance))
    x, y, z = (float(v) for v in found.camera.position)
    changed = document | {
        "mounting": {
            "measured": True,
            "x": x,
            "slider_y": y,
            "z": z,
            "rotation_vector": _plain(found.camera.rotation_vector),
            "deviation": {"position": _plain(deviation[:3]), "rotation": _plain(deviation[3:])},
        }
    }
    if "localizer" in document:
        worst = np.max(list(found.door_deviation.values()), axis=0)
        changed["localizer"] = document["localizer"] | {"mounting_deviation": _plain(worst)}
    return changed


def with_marks(document: dict[str, Any], found: MarkPlaces) -> dict[str, Any]:
    """A camera document with marks, their places replaced."""
    changed = {"deviation": found.deviation, "places": _plain(found.places)}
    return document | {"marks": document["marks"] | changed}


def with_empty_clamp(document: dict[str, Any], entry: EmptyClampEntry) -> dict[str, Any]:
    """A camera document with a picture of the empty clamp, in the place of one for that width."""
    others = [e for e in document.get("empty_clamp") or [] if abs(e["width"] - entry.width) > SAME_WIDTH]
    return document | {"empty_clamp": sorted([*others, asdict(entry)], key=lambda e: float(e["width"]))}


def write_document(document: dict[str, Any], path: Path) -> Path | None:
    """Write a camera document; what the file held before is kept, and where is returned.

    Pictures below its folder are named from there, so that the folder can be moved. The text is read back before it
    is put in place.

    Raises:
        BadCameraFile: What would be written is read by nothing; the file is as it was.
        OSError: It cannot be kept or written; the file is as it was.
    """
    folder = path.parent.absolute()

    def named(picture: str) -> str:
        return str(Path(picture).relative_to(folder)) if Path(picture).is_relative_to(folder) else picture

    document = _with_paths(document, named)
    text = yaml.safe_dump(document, sort_keys=False, default_flow_style=None)
    again, name = parse(text), unwritten(path)
    camera_of(again, name, path.parent)
    if "localizer" in document:
        settings_of(again, name)
    before = keep(path)
    write_atomically(path, text)
    return before


def unwritten(path: Path) -> str:
    """What messages call a document that was about to become `path`."""
    return f"{path}, which is not written,"


def _plain(values: FloatArray) -> list[float] | list[list[float]]:
    plain: list[float] | list[list[float]] = np.asarray(values, dtype=float).tolist()
    return plain
