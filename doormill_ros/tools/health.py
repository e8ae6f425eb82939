"""health: whether the cell can take a door, and what hinders it."""

from __future__ import annotations

import argparse
import sys

from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser, namespace

READY, NOT_READY = 0, 1


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(prog="health", description=__doc__)
    top.add_argument(
        "--namespace", type=namespace, default="", metavar="NS", help="of the cell, for example /cell1"
    )
    top.add_argument(
        "--wait", type=_seconds, default=5.0, metavar="S", help="longest wait until it is ready; default is 5"
    )
    top.add_argument("--robots", type=int, choices=(1, 2), default=1, help="2: two of them at one door")
    return top


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0.0 <= seconds <= 3600.0:
        raise argparse.ArgumentTypeError(f"found {text}, allowed are 0 to 3600 seconds")
    return seconds


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool; 0 for a cell that is ready, 1 with a line for each hindrance, 2 for a wrong command line."""
    options = parser().parse_args(argv)
    # Late, so that --help answers without ROS.
    from doormill_ros.nodes.clients.health import listen

    hindrances = listen(options.namespace, options.wait, options.robots)
    if not hindrances:
        print("ready")
        return READY
    print("not ready")
    for sentence in hindrances:
        print(f"  {sentence}")
    return NOT_READY


if __name__ == "__main__":
    sys.exit(main())
