"""calibrate extrinsics and calibrate check: pictures of a door moved by known steps."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import model_validator

from doormill_ros.arrays import ByteArray
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.config import read
from doormill_ros.localization.calibration.camera_file import (
    lens_covariance,
    read_document,
    unwritten,
    with_mounting,
    write_document,
)
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.extrinsics import (
    APART,
    Knowledge,
    calibrate_extrinsics,
)
from doormill_ros.localization.calibration.kept import keep
from doormill_ros.localization.calibration.moved_door import MovedDoor
from doormill_ros.localization.calibration.scale_test import scale_tests
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.localization.sensors.corner_edges import PictureQuality
from doormill_ros.localization.settings import LocalizerSettings, load_settings, settings_of
from doormill_ros.recipes.door import DoorSize
from doormill_ros.units import m_to_mm, mm_to_m, rad_to_deg
from doormill_ros.values import FiniteNumber, Name, Section, Vector3, contradiction

#: Gives the next picture of the camera.
Shutter = Callable[[], ByteArray]


_LONGEST = 1.0e4  # mm
_Length = Annotated[float, FiniteNumber("millimetres above 0, up to 10000", 0.0, _LONGEST, above=True)]
_Off = Annotated[float, FiniteNumber("millimetres from 0 to 10", 0.0, 10.0)]
_Grey = Annotated[float, FiniteNumber("a number of grey levels from 0 to 255", 0.0, 255.0)]
_Noise = Annotated[float, FiniteNumber("a number of grey levels above 0, up to 255", 0.0, 255.0, above=True)]


@dataclass(frozen=True, eq=False)
class _Move(Section):
    """One picture; move and thickness in millimetres."""

    picture: Name
    move: Vector3
    thickness: _Length | None = None


@dataclass(frozen=True, eq=False)
class Moves(Section):
    """The list of moves in docs/calibration.md, lengths in millimetres."""

    width: _Length
    height: _Length
    pictures: tuple[_Move, ...]
    thickness: _Length | None = None
    thickness_deviation: _Off = 0.05
    noise: _Noise = 2.0
    min_contrast: _Grey = 25.0

    @model_validator(mode="after")
    def _every_thickness(self) -> Moves:
        for i, entry in enumerate(self.pictures):
            if np.abs(entry.move).max() > _LONGEST:
                raise contradiction(
                    f"pictures.{i}.move is {entry.move.tolist()}, allowed are millimetres up to {_LONGEST:g}"
                )
            if entry.thickness is None and self.thickness is None:
                raise contradiction(f"pictures.{i}.thickness is missing, allowed is one there or one for all")
        return self

    def size(self, entry: _Move) -> DoorSize:
        """Size of the door in a picture [m]."""
        thickness = entry.thickness or self.thickness or 0.0
        return DoorSize(mm_to_m(self.width), mm_to_m(self.height), mm_to_m(thickness))


def extrinsics(arguments: argparse.Namespace, shutter: Shutter | None) -> tuple[list[str], bool]:
    """Calibrate the mounting; what to print, and whether the scale passed its test."""
    content, moved = _moved(arguments.moves, shutter)
    document = read_document(arguments.camera)
    camera, settings = load_camera(arguments.camera), load_settings(arguments.camera)
    lens = lens_covariance(document, camera, settings)
    known = replace(Knowledge(), thickness=mm_to_m(content.thickness_deviation), lens=lens)
    quality = PictureQuality(content.noise, content.min_contrast)
    found = calibrate_extrinsics(moved, camera, load_layout(), quality, known)
    mounted = with_mounting(document, found)
    tested, passed = _test(moved, found.camera, settings_of(mounted, unwritten(arguments.out)))
    before = write_document(mounted, arguments.out)
    deviation = np.sqrt(np.diag(found.covariance))
    lines = []
    for i, name in enumerate(("x", "slider_y", "z")):
        value, off = m_to_mm(found.camera.position[i]), m_to_mm(deviation[i])
        lines.append(f"{name} = {value:.3f} +- {off:.3f} mm")
    turn = rad_to_deg(found.camera.rotation_vector)
    lines.append(f"rotation vector = {', '.join(f'{v:.3f}' for v in turn)} deg, camera axes")
    for axis, thesis, model in zip("yz", found.scale, found.model_scale, strict=True):
        if np.isfinite(thesis):
            lines.append(
                f"scale along {axis}: {m_to_mm(thesis):.5f} mm/px by the move, {m_to_mm(model):.5f} by the camera"
            )
    for thickness, (y, z, rotation) in found.door_deviation.items():
        lines.append(
            f"leaves in a door of {m_to_mm(thickness):g} mm: y {m_to_mm(y):.4f} mm, z {m_to_mm(z):.4f} mm, "
            f"rotation {rad_to_deg(rotation):.4f} deg"
        )
    if found.needs_a_thick_door:
        lines.append(
            f"all pictures show doors of {' and '.join(f'{m_to_mm(t):g}' for t in found.thicknesses)} mm: lens and "
            "distance are hardly told apart, which the deviations above hold; for smaller ones add a picture of a door "
            f"{m_to_mm(APART):g} mm thicker or thinner in the reference place"
        )
    if before is not None:
        lines.append(f"the file before is kept as {before}; calibrate restore {arguments.out} puts it back")
    share = found.chi_square / found.redundancy
    lines.append(f"chi-square per degree of freedom {share:.2f}; {arguments.out}")
    return [*lines, *tested], passed


def check(arguments: argparse.Namespace, shutter: Shutter | None) -> tuple[list[str], bool]:
    """Test the scale; what to print, and whether it passed."""
    _, moved = _moved(arguments.moves, shutter)
    return _test(moved, load_camera(arguments.camera), load_settings(arguments.camera))


def _test(moved: list[MovedDoor], camera: CameraModel, settings: LocalizerSettings) -> tuple[list[str], bool]:
    results = scale_tests(moved, camera, load_layout(), settings)
    lines = []
    for result in results:
        made, seen = (", ".join(f"{m_to_mm(v):.3f}" for v in vector) for vector in (result.move, result.seen))
        verdict = "right" if result.passed else "WRONG: calibrate again, or measure the move"
        lines.append(
            f"picture {result.number + 1}: moved by y, z = {made} mm, seen {seen} mm, {m_to_mm(result.off):.3f} mm off "
            f"with a standard deviation of {m_to_mm(result.deviation):.3f} mm: {verdict}"
        )
    return lines, all(result.passed for result in results)


def _moved(path: Path, shutter: Shutter | None) -> tuple[Moves, list[MovedDoor]]:
    content = read(path, Moves, BadCalibrationFile, "see docs/calibration.md")
    files = [path.parent / entry.picture for entry in content.pictures]
    if shutter is not None:
        _take(content, files, shutter)
    pairs = zip(content.pictures, files, strict=True)
    return content, [
        MovedDoor(read_picture(file), mm_to_m(entry.move), content.size(entry)) for entry, file in pairs
    ]


def _take(content: Moves, files: list[Path], shutter: Shutter) -> None:
    """Ask for each move and take its picture; they are put in their files once all are there, earlier ones kept."""
    twice = [file for file, count in Counter(files).items() if count > 1]
    if twice:
        raise BadCalibrationFile(
            f"the list has {twice[0]} for two moves, allowed is a file for each; correct the list"
        )
    taken = []
    for entry in content.pictures:
        move = ", ".join(f"{v:g}" for v in entry.move)
        thickness = m_to_mm(content.size(entry).thickness)
        sys.stderr.write(
            f"door of {thickness:g} mm to x, y, z = {move} mm from the reference place, then Enter: "
        )
        sys.stderr.flush()
        if not sys.stdin.readline():
            raise BadCalibrationFile(
                f"nobody pressed Enter for move {move} mm, the input has ended; call the tool at a terminal"
            )
        taken.append(shutter())
    for picture, file in zip(taken, files, strict=True):
        before = keep(file, file.suffix)
        write_picture(np.repeat(picture[..., None], 3, axis=2), file)
        sys.stderr.write(f"{file} written" + (f", the one before is {before}\n" if before else "\n"))
