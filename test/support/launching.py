"""Run a launch file as `ros2 launch` does: `python -m support.launching FILE NAME:=VALUE ...`."""

from __future__ import annotations

import sys

from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

from launch import LaunchDescription, LaunchService


def main(file: str, *arguments: str) -> int:
    """Until it is interrupted; the exit status of launch."""
    given = [tuple(argument.split(":=", 1)) for argument in arguments]
    service = LaunchService(argv=list(arguments))
    source = PythonLaunchDescriptionSource(file)
    service.include_launch_description(
        LaunchDescription([IncludeLaunchDescription(source, launch_arguments=given)])
    )
    return int(service.run())


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
