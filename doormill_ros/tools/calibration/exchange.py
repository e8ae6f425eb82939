"""calibrate export, import and restore: camera files to and from ROS' form, and back to what was before."""

from __future__ import annotations

import argparse

from doormill_ros.localization.calibration.camera_file import (
    read_document,
    with_ros_intrinsics,
    write_document,
)
from doormill_ros.localization.calibration.kept import keep, kept, restore
from doormill_ros.localization.calibration.ros_file import read_ros_file, write_ros_file
from doormill_ros.localization.camera import load_camera


def to_ros(arguments: argparse.Namespace) -> list[str]:
    """Write the intrinsics as camera_calibration does; what to print."""
    camera = load_camera(arguments.camera)
    before = keep(arguments.out)
    write_ros_file(camera, arguments.name, arguments.out)
    lines = [f"intrinsics of {arguments.camera} as {arguments.name} in {arguments.out}"]
    if before is not None:
        lines.append(f"the file before is kept as {before}")
    return lines


def from_ros(arguments: argparse.Namespace) -> list[str]:
    """Take the intrinsics of a file of camera_calibration; what to print."""
    found = read_ros_file(arguments.file)
    before = write_document(with_ros_intrinsics(read_document(arguments.camera), found), arguments.out)
    lines = [
        f"intrinsics of {found.name or 'a camera without a name'} in {arguments.out}; mounting as it was"
    ]
    if before is not None:
        lines.append(f"the file before is kept as {before}; calibrate restore {arguments.out} puts it back")
    return lines


def put_back(arguments: argparse.Namespace) -> list[str]:
    """Put a kept calibration back, or list them; what to print."""
    if arguments.list:
        return [str(path) for path in kept(arguments.file)] or [f"nothing is kept of {arguments.file}"]
    source = restore(arguments.file, arguments.number)
    return [f"{arguments.file} is what {source} was; what it held before is kept as well"]
