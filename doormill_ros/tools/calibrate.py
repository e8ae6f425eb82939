"""calibrate: the camera, `calibrate intrinsics|extrinsics|check|marks|empty|lens|export|import|restore`.

Lengths on the command line and in the list of moves are millimetres.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.localization.calibration.camera_file import read_document, with_marks, write_document
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.lens_check import check_lens
from doormill_ros.localization.calibration.mark_places import measure_marks
from doormill_ros.localization.camera import FORM, load_camera
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.picture_file import read_picture
from doormill_ros.resources import resource
from doormill_ros.tools.calibration.boards import Stream, intrinsics
from doormill_ros.tools.calibration.doors import Shutter, check, extrinsics
from doormill_ros.tools.calibration.empty import COUNT, empty
from doormill_ros.tools.calibration.exchange import from_ros, put_back, to_ros
from doormill_ros.tools.command_line import written_over
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.units import m_to_mm

MOST_RADIAL = 1e6  # what was ever printed of a lens is far below


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run one command; 0 when it was done, 1 when a check failed, 2 for bad input."""
    parser = _parser()
    arguments = parser.parse_args(argv)
    if arguments.run is _lens and len(arguments.radial) not in (0, 3):
        parser.exit(
            2,
            f"calibration: {len(arguments.radial)} coefficients were given, allowed are three (k1 k2 k3) or none "
            "for those of the camera file\n",
        )
    given = vars(arguments)
    wrong = written_over(
        [given[name] for name in ("out", "coverage") if given.get(name) is not None],
        [*given.get("pictures", ()), *([given["moves"]] if "moves" in given else ())],
    )
    if wrong:
        sys.stderr.write(f"calibration: {wrong}\n")
        return 2
    try:
        arguments.status = 0
        lines = arguments.run(arguments)
    except (DoormillError, OSError) as error:
        sys.stderr.write(f"calibration: {error}\n")
        return 2
    sys.stdout.write("\n".join(lines) + "\n")
    return int(arguments.status)


def _intrinsics(arguments: argparse.Namespace) -> list[str]:
    return intrinsics(arguments, _stream(arguments))


def _empty(arguments: argparse.Namespace) -> list[str]:
    return empty(arguments, _stream(arguments))


def _stream(arguments: argparse.Namespace) -> Stream | None:
    """The pictures of the topic; None where files were given."""
    if arguments.topic is not None and arguments.pictures:
        raise BadCalibrationFile(
            f"{len(arguments.pictures)} pictures and the topic {arguments.topic} were given, allowed is one of both; "
            "leave the files or --topic out"
        )
    if arguments.topic is not None:
        return partial(_listen, arguments)
    if not arguments.pictures:
        raise BadCalibrationFile(
            "neither pictures nor a topic were given; give files, or --topic camera/image_raw"
        )
    for option in ("save", "count"):
        if getattr(arguments, option, None) is not None:
            raise BadCalibrationFile(
                f"--{option} was given with files, allowed is that with --topic; leave it out"
            )
    return None


def _extrinsics(arguments: argparse.Namespace) -> list[str]:
    lines, passed = extrinsics(arguments, _shutter(arguments))
    arguments.status = 0 if passed else 1
    return lines


def _check(arguments: argparse.Namespace) -> list[str]:
    lines, passed = check(arguments, _shutter(arguments))
    arguments.status = 0 if passed else 1
    return lines


def _listen(arguments: argparse.Namespace, take: Callable[[ByteArray], bool]) -> None:
    # Late, so that files are calibrated without ROS.
    from doormill_ros.nodes.clients.picture_listener import listen

    listen(arguments.topic, take, arguments.wait)


def _shutter(arguments: argparse.Namespace) -> Shutter | None:
    """Takes the next picture of the topic; None without one."""
    if arguments.topic is None:
        return None

    def shutter() -> ByteArray:
        taken: list[ByteArray] = []

        def take(picture: ByteArray) -> bool:
            taken.append(picture)
            return True

        _listen(arguments, take)
        if not taken:
            raise BadPicture("the camera's picture was not waited for; start again")
        return taken[0]

    return shutter


def _marks(arguments: argparse.Namespace) -> list[str]:
    pictures = [read_picture(path) for path in arguments.pictures]
    found = measure_marks(pictures, load_camera(arguments.camera))
    before = write_document(with_marks(read_document(arguments.camera), found), arguments.out)
    lines = [
        f"mark {i + 1}: y = {m_to_mm(y):.3f} mm at a door width of zero, z = {m_to_mm(z):.3f} mm, "
        f"{m_to_mm(moved):.3f} mm from where the file had it"
        for i, ((y, z), moved) in enumerate(zip(found.places, found.moved, strict=True))
    ]
    if before is not None:
        lines.append(f"the file before is kept as {before}; calibrate restore {arguments.out} puts it back")
    return [*lines, f"standard deviation {m_to_mm(found.deviation):.4f} mm; {arguments.out}"]


def _lens(arguments: argparse.Namespace) -> list[str]:
    camera = load_camera(arguments.camera)
    shipped = (camera.distortion[0], camera.distortion[1], camera.distortion[4])
    radial = tuple(arguments.radial or shipped)
    if not all(abs(value) <= MOST_RADIAL for value in radial):
        raise BadCalibrationFile(
            f"the radial coefficients are {', '.join(f'{v:g}' for v in radial)}, allowed are numbers up to "
            f"{MOST_RADIAL:g}; give k1 k2 k3 of a calibration"
        )
    found, focal = check_lens(camera.k, camera.size, radial), camera.focal
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
    parser = OneLineParser(prog="calibrate", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    boards = commands.add_parser("intrinsics", help="camera matrix and distortion from chessboard pictures")
    boards.add_argument("pictures", nargs="*", type=Path)
    boards.add_argument(
        "--board", nargs=2, type=int, default=(9, 6), metavar=("COLUMNS", "ROWS"), help="inner corners"
    )
    boards.add_argument("--square", type=float, required=True, help="side of a square [mm]")
    boards.add_argument("--radial", type=int, choices=(1, 2, 3), default=2, help="radial coefficients")
    boards.add_argument(
        "--coverage", type=Path, help="picture to draw of where corners were seen, .png or .jpg"
    )
    boards.add_argument("--save", type=Path, help="folder for the pictures that were taken from the topic")
    boards.set_defaults(run=_intrinsics)

    doors = commands.add_parser("extrinsics", help="mounting from pictures of a door moved by known steps")
    doors.set_defaults(run=_extrinsics)
    test = commands.add_parser("check", help="whether a moved door is seen to have moved as far; 1 if not")
    test.set_defaults(run=_check)
    for command in (doors, test):
        command.add_argument(
            "moves", type=Path, help="YAML list of pictures and moves, see docs/calibration.md"
        )
    marks = commands.add_parser("marks", help="places of the cell's marks, by the calibrated camera")
    marks.add_argument("pictures", nargs="+", type=Path)
    marks.set_defaults(run=_marks)

    bare = commands.add_parser("empty", help="picture of the empty clamp, to tell its parts from a door")
    bare.add_argument("pictures", nargs="*", type=Path)
    bare.add_argument(
        "--width", type=float, required=True, help="door width for which the slider stands [mm]"
    )
    bare.add_argument("--count", type=int, help=f"pictures to take from the topic; {COUNT} unless given")
    bare.add_argument(
        "--sure", action="store_true", help="the clamp is empty, though a part of it looks like a door"
    )
    bare.set_defaults(run=_empty)

    lens = commands.add_parser("lens", help="what distortion coefficients do inside the picture")
    lens.add_argument(
        "radial", nargs="*", type=float, help="k1 k2 k3; those of the camera file when left out"
    )
    # Python's own, before 3.14, takes -1e-3 for an option.
    lens._negative_number_matcher = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
    lens.set_defaults(run=_lens)

    export = commands.add_parser("export", help="intrinsics as ROS' camera_calibration writes them")
    export.add_argument("--name", default="camera", help="of the camera")
    export.set_defaults(run=to_ros)
    taken = commands.add_parser("import", help="intrinsics from a file of ROS' camera_calibration")
    taken.add_argument("file", type=Path)
    taken.set_defaults(run=from_ros)
    back = commands.add_parser("restore", help="put the calibration before back")
    back.add_argument("file", type=Path, help="camera file")
    back.add_argument("--number", type=int, help="which one; without it the newest that differs")
    back.add_argument("--list", action="store_true", help="only list what is kept")
    back.set_defaults(run=put_back)

    for command in (boards, doors, test, bare):
        command.add_argument("--topic", help="take the pictures from this topic, such as camera/image_raw")
        command.add_argument("--wait", type=float, default=600.0, help="for a picture, or for all boards [s]")
    for command in (boards, doors, marks, bare, export, taken):
        command.add_argument("--out", type=Path, required=True, help="file to write")
    for command in (boards, doors, test, marks, bare, lens, export, taken):
        command.add_argument("--camera", type=Path, default=resource(FORM), help="camera file to start from")
    return parser


if __name__ == "__main__":
    sys.exit(main())
