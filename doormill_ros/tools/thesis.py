"""thesis: what the printed figures of the master's thesis behind the project say.

`thesis identify --out OUT` recovers the joint stiffness of its six loading tests (as `identify --thesis` does),
`thesis diagnose --out OUT` questions tables 4.2 and 4.3 (as `diagnose --thesis` does), and `thesis contradictions`
lists the printed figures that contradict each other, each with its proof.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from pathlib import Path

from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser


def identify(out: Path) -> list[str]:
    """Write identification.json and robot.yaml; the lines to print."""
    from doormill_ros.thesis.loading_tests import load_thesis_data
    from doormill_ros.thesis.outcome import outcome_of_thesis

    outcome = outcome_of_thesis(load_thesis_data())
    files = outcome.write(out)
    return [*outcome.lines, "wrote " + ", ".join(map(str, files))]


def diagnose(out: Path) -> list[str]:
    """Write diagnosis.json, model.yaml and report.html; the verdict."""
    from doormill_ros.thesis.run import run_thesis

    return [run_thesis(out)]


def contradictions() -> list[str]:
    """One line for every contradiction."""
    from doormill_ros.thesis.loading_tests import load_thesis_data
    from doormill_ros.thesis.outcome import find_contradictions
    from doormill_ros.thesis.recovery import recover

    data = load_thesis_data()
    return [str(one) for one in find_contradictions(data, recover(data))]


@interruptible
def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tool; 2 when a file cannot be read or written."""
    parser = OneLineParser(
        prog="thesis", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name, text in (
        ("identify", "joint stiffness from the six loading tests"),
        ("diagnose", "what the simulation of table 4.2 left out"),
    ):
        command = commands.add_parser(name, help=text)
        command.add_argument("--out", metavar="OUT", type=Path, required=True, help="folder for the results")
    commands.add_parser("contradictions", help="printed figures that contradict each other")
    chosen = parser.parse_args(arguments)
    logging.basicConfig(level=logging.ERROR)
    try:
        if chosen.command == "contradictions":
            lines = contradictions()
        else:
            lines = {"identify": identify, "diagnose": diagnose}[chosen.command](chosen.out)
    except (DoormillError, OSError) as error:
        print(f"thesis: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
