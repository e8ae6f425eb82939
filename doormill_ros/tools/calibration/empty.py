"""calibrate empty: a picture of the empty clamp, with which those of doors are compared."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.calibration.camera_file import read_document, with_empty_clamp, write_document
from doormill_ros.localization.calibration.empty_picture import empty_picture
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClampEntry
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.tools.calibration.boards import Stream
from doormill_ros.units import mm_to_m

COUNT, MOST = 5, 100  # pictures that are averaged: of a topic unless told otherwise, and at most


def empty(arguments: argparse.Namespace, stream: Stream | None) -> list[str]:
    """Take the pictures, keep their mean beside the camera file and enter it there; what to print."""
    count = COUNT if arguments.count is None else arguments.count
    if not 1 <= count <= MOST:
        raise BadCalibrationFile(f"{count} pictures are asked for, allowed are 1 to {MOST}; give --count N")
    pictures = [read_picture(path) for path in arguments.pictures] if stream is None else _live(stream, count)
    width = round(mm_to_m(arguments.width), 9)  # a file for people
    made = empty_picture(pictures, load_camera(arguments.camera), load_layout(), width, arguments.sure)
    document = read_document(arguments.camera)
    file = _next(arguments.out)
    write_picture(np.repeat(made.picture[..., None], 3, axis=2), file)
    entry = EmptyClampEntry(width, str(file.absolute()), made.noise, made.count, time.strftime("%Y-%m-%d"))
    before = write_document(with_empty_clamp(document, entry), arguments.out)
    lines = [
        f"the empty clamp for doors of {arguments.width:g} mm: {made.count} "
        f"{'picture' if made.count == 1 else 'pictures'}, noise {made.noise:.2f} grey levels; {file}"
    ]
    if before is not None:
        lines.append(f"the file before is kept as {before}; calibrate restore {arguments.out} puts it back")
    return [*lines, f"{arguments.out}"]


def _live(stream: Stream, count: int) -> list[ByteArray]:
    taken: list[ByteArray] = []

    def take(picture: ByteArray) -> bool:
        if taken and picture.shape != taken[0].shape:
            raise BadCalibrationFile(
                f"pictures of {taken[0].shape[1]} x {taken[0].shape[0]} px and of {picture.shape[1]} x "
                f"{picture.shape[0]} px came, allowed is one size; start again"
            )
        taken.append(picture)
        return len(taken) >= count

    stream(take)
    return taken


def _next(out: Path) -> Path:
    """The next free name in the folder of pictures beside a camera file: none is written over, old files name them."""
    folder = out.with_name(f"{out.name}.empty")
    folder.mkdir(parents=True, exist_ok=True)
    numbers = [int(path.stem) for path in folder.glob("*.png") if path.stem.isdecimal()]
    return folder / f"{max(numbers, default=0) + 1:03d}.png"
