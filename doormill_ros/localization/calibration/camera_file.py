"""Write what a calibration found into a file of the form of config/camera.yaml."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros import config
from doormill_ros.arrays import FloatArray
from doormill_ros.files import write_atomically
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.extrinsics import Extrinsics
from doormill_ros.localization.calibration.intrinsics import Intrinsics
from doormill_ros.localization.calibration.kept import keep
from doormill_ros.localization.calibration.mark_places import MarkPlaces
from doormill_ros.localization.calibration.ros_file import RosIntrinsics
from doormill_ros.localization.empty_clamp import SAME_WIDTH, EmptyClampEntry


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
    """A camera document with the intrinsics replaced; `names` are those of the pictures."""
    return document | {
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
    """A camera document with the intrinsics of a ROS file, which does not say how sure they are."""
    changed = document | {
        "size": list(found.size),
        "intrinsics": {"measured": True, "k": _plain(found.k)},
        "distortion": {"measured": True, "coefficients": _plain(found.distortion)},
    }
    changed.pop("chessboard", None)
    return changed


def lens_covariance(document: dict[str, Any]) -> FloatArray:
    """Covariance of fx, fy, cx, cy [px] and the five distortion coefficients, shape (9, 9), of a camera document.

    Without a calibration of ours it is a focal length off by the localiser's `lens_deviation`, alike along both axes.
    """
    covariance = np.array((document.get("chessboard") or {}).get("covariance", []), dtype=float)
    if covariance.shape == (9, 9) and np.all(np.isfinite(covariance)):
        return covariance
    k = np.array(document["intrinsics"]["k"], dtype=float)
    off = np.zeros(9)
    off[:2] = (document.get("localizer") or {}).get("lens_deviation", 0.0) * k[[0, 1], [0, 1]]
    return np.outer(off, off)


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

    Pictures below its folder are named from there, so that the folder can be moved.

    Raises:
        OSError: It cannot be kept or written; the file is as it was.
    """
    folder = path.parent.absolute()

    def named(picture: str) -> str:
        return str(Path(picture).relative_to(folder)) if Path(picture).is_relative_to(folder) else picture

    document = _with_paths(document, named)
    before = keep(path)
    write_atomically(path, yaml.safe_dump(document, sort_keys=False, default_flow_style=None))
    return before


def _plain(values: FloatArray) -> list[float] | list[list[float]]:
    plain: list[float] | list[list[float]] = np.asarray(values, dtype=float).tolist()
    return plain
