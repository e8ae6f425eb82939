"""calibrate intrinsics: pictures of a chessboard, from files or as a camera sends them."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.calibration.board_shape import refuse_square
from doormill_ros.localization.calibration.board_view import BoardPicture, judge
from doormill_ros.localization.calibration.camera_file import read_document, with_intrinsics, write_document
from doormill_ros.localization.calibration.chessboard import Chessboard
from doormill_ros.localization.calibration.coverage import Coverage, coverage, draw_coverage
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.intrinsics import (
    Intrinsics,
    calibrate_intrinsics,
    check_corner,
)
from doormill_ros.localization.calibration.lens_check import check_lens
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.localization.pictures.picture_folder import SUFFIXES
from doormill_ros.units import m_to_mm, mm_to_m

CORNERS = (3, 100)  # inner corners each way; the detector takes no fewer
SQUARES = (1e-4, 1.0)  # side [m]
#: Hands pictures to a function until it says that they are enough.
Stream = Callable[[Callable[[ByteArray], bool]], None]


def intrinsics(arguments: argparse.Namespace, stream: Stream | None) -> list[str]:
    """Calibrate; what to print."""
    columns, rows = arguments.board
    board = _board(columns, rows, arguments.square)
    document = read_document(arguments.camera)
    views, size = (
        _from_files(arguments.pictures, board) if stream is None else _live(stream, board, arguments.save)
    )
    seen = coverage([v.corners for v in views if v.corners is not None], board, size)
    if arguments.coverage is not None:
        write_picture(draw_coverage(seen), arguments.coverage)
    lines = _views(views, seen)
    try:
        found = calibrate_intrinsics([v.corners for v in views], board, size, arguments.radial)
        check_corner(found)
    except Exception:
        sys.stdout.write("\n".join(lines) + "\n")  # the reasons are worth most when it fails
        raise
    names = [v.name for v in views]
    before = write_document(with_intrinsics(document, found, names), arguments.out)
    lines = [*_views(views, seen, found), *_numbers(found)]
    if before is not None:
        lines.append(f"the file before is kept as {before}; calibrate restore {arguments.out} puts it back")
    return [
        *lines,
        f"{int(found.used.sum())} of {len(names)} pictures used, {found.error:.3f} px; {arguments.out}",
    ]


def _board(columns: int, rows: int, square: float) -> Chessboard:
    """The board of the command line; its squares in mm."""
    fewest, most = CORNERS
    if not (fewest <= columns <= most and fewest <= rows <= most):
        raise BadCalibrationFile(
            f"a board of {columns} x {rows} inner corners is given, allowed are {fewest} to {most} each way; count "
            "the corners where four squares meet, and give --board COLUMNS ROWS"
        )
    low, high = SQUARES
    if not low <= mm_to_m(square) <= high:
        raise BadCalibrationFile(
            f"squares of {square:g} mm are given, allowed are {m_to_mm(low):g} to {m_to_mm(high):g} mm; measure the "
            "printed board, and give --square MM"
        )
    board = Chessboard(columns, rows, mm_to_m(square))
    refuse_square(board)
    return board


def _from_files(paths: list[Path], board: Chessboard) -> tuple[list[BoardPicture], tuple[int, int]]:
    paths = list(dict.fromkeys(paths))
    pictures = [read_picture(path) for path in paths]
    sizes = {(int(picture.shape[1]), int(picture.shape[0])) for picture in pictures}
    if len(sizes) != 1:
        raise BadCalibrationFile(f"the pictures have sizes {sorted(sizes)}, allowed is one; sort them")
    views: list[BoardPicture] = []
    count = Counter(path.name for path in paths)
    for path, picture in zip(paths, pictures, strict=True):
        # The camera file holds each picture's record by its name.
        name = path.name if count[path.name] == 1 else str(path)
        views.append(judge(picture, name, board, views))
    return views, sizes.pop()


def _live(
    stream: Stream, board: Chessboard, folder: Path | None
) -> tuple[list[BoardPicture], tuple[int, int]]:
    """Judge pictures as they come, and say what to show next, until no view is missing."""
    if folder is not None:
        _refuse_pictures_in(folder)
    views: list[BoardPicture] = []
    sizes: list[tuple[int, int]] = []
    said = [""]

    def say(sentence: str) -> None:
        if sentence != said[-1]:  # a camera sends the same thing many times a second
            said.append(sentence)
            sys.stderr.write(sentence + "\n")

    def take(picture: ByteArray) -> bool:
        size = (int(picture.shape[1]), int(picture.shape[0]))
        if sizes and size != sizes[0]:
            raise BadCalibrationFile(
                f"pictures of {sizes[0]} and of {size} px came, allowed is one size; start again"
            )
        name = f"{len(views) + 1:03d}.png"
        view = judge(picture, name, board, views)
        if view.corners is None:
            say(view.reason)
            return False
        sizes[:] = [size]
        views.append(view)
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            write_picture(np.repeat(picture[..., None], 3, axis=2), folder / name)
        missing = coverage([v.corners for v in views if v.corners is not None], board, size).missing
        say(
            f"{name} taken; " + (f"show {missing[-1]} ({len(missing)} missing)" if missing else "that is all")
        )
        return not missing

    stream(take)
    if not views:
        raise BadCalibrationFile(
            "no picture of use came from the camera; check the topic, and hold the board into view"
        )
    return views, sizes[0]


def _refuse_pictures_in(folder: Path) -> None:
    """Those of another session would be written over, and calibrated together with these."""
    present = sorted(p.name for p in folder.glob("*") if p.suffix.lower() in SUFFIXES)
    if present:
        raise BadCalibrationFile(
            f"the folder {folder} holds {len(present)} pictures already, such as {present[0]}, allowed is an empty or "
            "a new one; give another --save"
        )


def _views(views: list[BoardPicture], seen: Coverage, found: Intrinsics | None = None) -> list[str]:
    lines = []
    for i, view in enumerate(views):
        if view.reason:
            lines.append(f"{view.name}: refused, {view.reason}")
        elif found is None:
            lines.append(f"{view.name}: taken")
        else:
            note = "" if found.used[i] else "  rejected: it stands out from the others"
            lines.append(f"{view.name}: {found.picture_error[i]:.3f} px{note}")
    return lines + [f"missing: {sentence}" for sentence in seen.missing]


def _numbers(found: Intrinsics) -> list[str]:
    lines = []
    values = (found.k[0, 0], found.k[1, 1], found.k[0, 2], found.k[1, 2])
    for name, value, deviation in zip(("fx", "fy", "cx", "cy"), values, found.k_deviation, strict=True):
        lines.append(f"{name} = {value:.2f} +- {deviation:.2f} px")
    for name, value, deviation in zip(
        ("k1", "k2", "p1", "p2", "k3"), found.distortion, found.distortion_deviation, strict=True
    ):
        lines.append(f"{name} = {value:.5f} +- {deviation:.5f}")
    lens = check_lens(found.k, found.size, (found.distortion[0], found.distortion[1], found.distortion[4]))
    lines.append(f"corners reach {found.covered:.2f} of the {lens.corner:.2f} to the picture's corner")
    shape = found.shape
    return [
        *lines,
        f"the board is bowed by {m_to_mm(shape.bow):.3f} +- {m_to_mm(shape.bow_deviation):.3f} mm, its columns are "
        f"stretched by {100 * shape.stretch:.3f} +- {100 * shape.stretch_deviation:.3f} % against its rows; both are "
        "taken into account",
    ]
