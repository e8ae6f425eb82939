"""calibrate: the camera, `calibrate intrinsics|extrinsics|marks|lens`.

Lengths on the command line and in the list of moves are millimetres.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import model_validator

from doormill_ros.cell.layout import load_layout
from doormill_ros.config import read
from doormill_ros.errors import DoormillError
from doormill_ros.localization.calibration.camera_file import (
    read_document,
    with_intrinsics,
    with_marks,
    with_mounting,
    write_document,
)
from doormill_ros.localization.calibration.chessboard import Chessboard, find_corners
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.extrinsics import MovedDoor, calibrate_extrinsics
from doormill_ros.localization.calibration.intrinsics import calibrate_intrinsics
from doormill_ros.localization.calibration.lens_check import check_lens
from doormill_ros.localization.calibration.mark_places import measure_marks
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.picture_file import read_picture
from doormill_ros.localization.sensors.corner_edges import PictureQuality
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.units import m_to_mm, mm_to_m, rad_to_deg
from doormill_ros.values import Name, NotNegative, Positive, Section, Vector3, contradiction


@dataclass(frozen=True, eq=False)
class _Move(Section):
    """One picture; move and thickness in millimetres."""

    picture: Name
    move: Vector3
    thickness: Positive | None = None


@dataclass(frozen=True, eq=False)
class _Moves(Section):
    """The list of moves in docs/calibration.md, lengths in millimetres."""

    width: Positive
    height: Positive
    pictures: tuple[_Move, ...]
    thickness: Positive | None = None
    noise: NotNegative = 2.0
    min_contrast: NotNegative = 25.0

    @model_validator(mode="after")
    def _every_thickness(self) -> _Moves:
        for i, entry in enumerate(self.pictures):
            if entry.thickness is None and self.thickness is None:
                raise contradiction(f"pictures.{i}.thickness is missing, allowed is one there or one for all")
        return self

    def size(self, entry: _Move) -> DoorSize:
        """Size of the door in a picture [m]."""
        thickness = entry.thickness or self.thickness or 0.0
        return DoorSize(mm_to_m(self.width), mm_to_m(self.height), mm_to_m(thickness))


def main(argv: list[str] | None = None) -> int:
    """Run one calibration; 0 when it was written, 2 for bad input."""
    parser = _parser()
    arguments = parser.parse_args(argv)
    if arguments.run is _lens and len(arguments.radial) not in (0, 3):
        parser.exit(
            2,
            f"calibration: {len(arguments.radial)} coefficients were given, allowed are three (k1 k2 k3) or none "
            "for those of the camera file\n",
        )
    try:
        lines = arguments.run(arguments)
    except (DoormillError, OSError) as error:
        sys.stderr.write(f"calibration: {error}\n")
        return 2
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _intrinsics(arguments: argparse.Namespace) -> list[str]:
    columns, rows = arguments.board
    board = Chessboard(columns, rows, mm_to_m(arguments.square))
    pictures = [read_picture(path) for path in arguments.pictures]
    sizes = {picture.shape[::-1] for picture in pictures}
    if len(sizes) != 1:
        raise BadCalibrationFile(f"the pictures have sizes {sorted(sizes)}, allowed is one; sort them")
    corners = [find_corners(picture, board) for picture in pictures]
    found = calibrate_intrinsics(corners, board, sizes.pop(), arguments.radial)
    names = [path.name for path in arguments.pictures]
    write_document(with_intrinsics(read_document(arguments.camera), found, names), arguments.out)
    lines = []
    for name, error, use in zip(names, found.picture_error, found.used, strict=True):
        note = "" if use else "  rejected" if np.isfinite(error) else "  no board found"
        lines.append(f"{name}: {error:.3f} px{note}")
    values = (found.k[0, 0], found.k[1, 1], found.k[0, 2], found.k[1, 2])
    for name, value, deviation in zip(("fx", "fy", "cx", "cy"), values, found.k_deviation, strict=True):
        lines.append(f"{name} = {value:.2f} +- {deviation:.2f} px")
    for name, value, deviation in zip(
        ("k1", "k2", "p1", "p2", "k3"), found.distortion, found.distortion_deviation, strict=True
    ):
        lines.append(f"{name} = {value:.5f} +- {deviation:.5f}")
    lens = check_lens(found.k, found.size, (found.distortion[0], found.distortion[1], found.distortion[4]))
    lines.append(f"corners reach {found.covered:.2f} of the {lens.corner:.2f} to the picture's corner")
    return [
        *lines,
        f"{int(found.used.sum())} of {len(names)} pictures used, {found.error:.3f} px; {arguments.out}",
    ]


def _extrinsics(arguments: argparse.Namespace) -> list[str]:
    content = read(arguments.moves, _Moves, BadCalibrationFile, "see docs/calibration.md")
    moved = [
        MovedDoor(
            read_picture(arguments.moves.parent / entry.picture), mm_to_m(entry.move), content.size(entry)
        )
        for entry in content.pictures
    ]
    quality = PictureQuality(content.noise, content.min_contrast)
    found = calibrate_extrinsics(moved, load_camera(arguments.camera), load_layout(), quality)
    write_document(with_mounting(read_document(arguments.camera), found), arguments.out)
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
    share = found.chi_square / found.redundancy
    return [*lines, f"chi-square per degree of freedom {share:.2f}; {arguments.out}"]


def _marks(arguments: argparse.Namespace) -> list[str]:
    pictures = [read_picture(path) for path in arguments.pictures]
    found = measure_marks(pictures, load_camera(arguments.camera), mm_to_m(arguments.width))
    write_document(with_marks(read_document(arguments.camera), found), arguments.out)
    lines = [
        f"mark {i + 1}: y = {m_to_mm(y):.3f} mm at a door width of zero, z = {m_to_mm(z):.3f} mm, "
        f"{m_to_mm(moved):.3f} mm from where the file had it"
        for i, ((y, z), moved) in enumerate(zip(found.places, found.moved, strict=True))
    ]
    return [*lines, f"standard deviation {m_to_mm(found.deviation):.4f} mm; {arguments.out}"]


def _lens(arguments: argparse.Namespace) -> list[str]:
    camera = load_camera(arguments.camera)
    shipped = (camera.distortion[0], camera.distortion[1], camera.distortion[4])
    found = check_lens(camera.k, camera.size, tuple(arguments.radial or shipped))
    focal = float(np.sqrt(camera.k[0, 0] * camera.k[1, 1]))
    lines = [
        f"the picture's corner is at r = {found.corner:.3f}, {found.corner * focal:.0f} px from the centre"
    ]
    if np.isfinite(found.fold):
        lines.append(
            f"r' stops growing at r = {found.fold:.3f} with r' = {found.reach:.3f}, {found.reach * focal:.0f} px: "
            f"{found.blind_share:.0%} of the picture has no ray"
        )
    lines.append(f"a ray to the corner is moved by {found.corner_shift:.0f} px")
    lines.append(f"below 2 % up to r = {found.usable:.3f}")
    return lines


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="calibrate", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    shipped = resource("config/camera.yaml")

    intrinsics = commands.add_parser(
        "intrinsics", help="camera matrix and distortion from chessboard pictures"
    )
    intrinsics.add_argument("pictures", nargs="+", type=Path)
    intrinsics.add_argument(
        "--board", nargs=2, type=int, default=(9, 6), metavar=("COLUMNS", "ROWS"), help="inner corners"
    )
    intrinsics.add_argument("--square", type=float, required=True, help="side of a square [mm]")
    intrinsics.add_argument("--radial", type=int, choices=(1, 2, 3), default=2, help="radial coefficients")
    intrinsics.set_defaults(run=_intrinsics)

    extrinsics = commands.add_parser(
        "extrinsics", help="mounting from pictures of a door moved by known steps"
    )
    extrinsics.add_argument(
        "moves", type=Path, help="YAML list of pictures and moves, see docs/calibration.md"
    )
    extrinsics.set_defaults(run=_extrinsics)

    marks = commands.add_parser("marks", help="places of the cell's marks, by the calibrated camera")
    marks.add_argument("pictures", nargs="+", type=Path)
    marks.add_argument(
        "--width", type=float, required=True, help="door width for which the slider stands [mm]"
    )
    marks.set_defaults(run=_marks)

    for command in (intrinsics, extrinsics, marks):
        command.add_argument("--out", type=Path, required=True, help="camera file to write")
    lens = commands.add_parser("lens", help="what distortion coefficients do inside the picture")
    lens.add_argument(
        "radial", nargs="*", type=float, help="k1 k2 k3; those of the camera file when left out"
    )
    lens.set_defaults(run=_lens)
    for command in (intrinsics, extrinsics, marks, lens):
        command.add_argument("--camera", type=Path, default=shipped, help="camera file to start from")
    return parser


if __name__ == "__main__":
    sys.exit(main())
