"""Runs a whole diagnosis of the camera from a picture set and writes its file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.cell.layout import load_layout
from doormill_ros.diagnosis.camera.residuals import CameraDiagnosis, CameraFinding, diagnose_pictures
from doormill_ros.files import write_atomically
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.result import Localization
from doormill_ros.measurements.picture_reading import localisations_of
from doormill_ros.measurements.picture_set import PictureSet, read_picture_set

SCHEMA = "doormill/diagnosis/1"
FEWEST_PLACES = 4  #: of the door; whole places are left out, predicted and compared


def run_pictures(folder: Path, out: Path, progress: Callable[[str], None] = lambda line: None) -> str:
    """Localize the pictures of a set, question the camera model with them, write diagnosis.json.

    Args:
        folder: The picture set.
        out: Folder for the result.
        progress: Told of every step.

    Returns:
        The verdict in one line.

    Raises:
        DataSetError: The set cannot be read, or too few of its pictures show the door; nothing is written.
        BadCameraFile: The camera file cannot be used.
    """
    pictures = read_picture_set(folder)
    found, refused = _localize(pictures, progress)
    rows = sorted(found)
    if len(np.unique(np.round(pictures.moved[rows], 6), axis=0)) < FEWEST_PLACES:
        raise pictures.table.fail(
            len(pictures) - 1,
            "picture",
            f"{len(rows)} of {len(pictures)} pictures show the door, at fewer than {FEWEST_PLACES} places; move it "
            "to more",
        )
    diagnosis = diagnose_pictures(
        localisations_of(
            [found[row] for row in rows],
            [pictures.offset(row) for row in rows],
            pictures.time[rows],
            pictures.camera,
            load_layout(),
            pictures.width,
            pictures.thickness,
        )
    )
    document = _document(diagnosis, len(rows), refused)
    out.mkdir(parents=True, exist_ok=True)
    write_atomically(out / "diagnosis.json", json.dumps(document, indent=2, allow_nan=False) + "\n")
    return verdict_line(diagnosis)


def _localize(
    pictures: PictureSet, progress: Callable[[str], None]
) -> tuple[dict[int, Localization], list[dict[str, Any]]]:
    """What the localizer says of each picture by row, and the refusals."""
    # One door and one camera: its thickness and the mounting are the same in all pictures and scatter in none.
    layout, settings = load_layout(), pictures.settings.picture_only()
    found: dict[int, Localization] = {}
    refused: list[dict[str, Any]] = []
    for row, name in enumerate(pictures.names):
        progress(f"localizing {name}")
        try:
            found[row] = localize(
                pictures.picture(row),
                pictures.camera,
                layout,
                pictures.width,
                pictures.thickness,
                settings=settings,
            )
        except LocalizationError as error:
            refused.append({"picture": name, "error_code": error.code, "reason": error.message})
    return found, refused


def verdict_line(diagnosis: CameraDiagnosis) -> str:
    """The verdict and what it rests on, in one line."""
    before, after = diagnosis.before, diagnosis.after
    if diagnosis.verdict == "consistent":
        return f"consistent: the residual is {before:.2f} times the localizer's own uncertainty"
    if diagnosis.verdict == "unexplained":
        return f"unexplained: {before:.2f} times the localizer's own uncertainty, and no known cause earns its place"
    names = " and ".join(finding.cause.name for finding in diagnosis.findings)
    return f"explained: {names}; held-out residual {before:.2f} -> {after:.2f} times the localizer's own uncertainty"


def _document(diagnosis: CameraDiagnosis, used: int, refused: list[dict[str, Any]]) -> dict[str, Any]:
    """The content of diagnosis.json; residuals in standard deviations of one localization, so the noise is 1."""
    return {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict,
        "unit": "standard deviations of one localization",
        "noise_floor": 1.0,
        "baseline": {"holdout_rmse": diagnosis.before},
        "extended": {"holdout_rmse": diagnosis.after},
        "gain": {"holdout_rmse_ratio": diagnosis.after / diagnosis.before},
        "causes": [_cause(finding) for finding in diagnosis.findings],
        "pictures": used,
        "refused": refused,
    }


def _cause(finding: CameraFinding) -> dict[str, Any]:
    (parameter,) = finding.cause.parameters
    value, std = (numbers.tolist() for numbers in (finding.values, finding.std))
    single = parameter.size == 1
    return {
        "cause": finding.cause.name,
        "where": finding.cause.where,
        "pattern": finding.cause.pattern(),
        "parameters": {
            parameter.name: {
                "value": value[0] if single else value,
                "std": std[0] if single else std,
                "unit": parameter.unit,
            }
        },
        "confusable_with": [{"cause": name, "where": finding.cause.where} for name in finding.confusable],
    }
