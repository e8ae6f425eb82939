"""Tell what a simulation gets wrong: `diagnose --data DIR [--data DIR ...] [--check DIR ...] --out OUT`.

With `--thesis` in place of `--data` it questions the thesis' own loading tests (tables 4.2 and 4.3), with
`--pictures DIR` the camera model by pictures of a door that was moved by known amounts, with `--inspections DIR` the
robot's springs by inspected doors and the bags of their runs.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from doormill_ros.errors import DoormillError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tool; 0 for every verdict, 2 for data that cannot be read."""
    parser = argparse.ArgumentParser(prog="diagnose", description=__doc__)
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--data", metavar="DIR", type=Path, action="append", default=[], help="set to diagnose"
    )
    source.add_argument("--thesis", action="store_true", help="the loading tests that the thesis prints")
    source.add_argument("--pictures", metavar="DIR", type=Path, help="pictures of a moved door")
    source.add_argument("--inspections", metavar="DIR", type=Path, help="one or many inspected doors")
    parser.add_argument(
        "--check", metavar="DIR", type=Path, action="append", default=[], help="set to predict only"
    )
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="folder for the results")
    parser.add_argument("--quiet", action="store_true", help="print the verdict only")
    chosen = parser.parse_args(arguments)
    if chosen.check and not chosen.data:
        other = next(name for name in ("thesis", "pictures", "inspections") if getattr(chosen, name))
        parser.exit(
            2, f"diagnose: --check was given with --{other}, allowed is --check with --data; leave one out\n"
        )
    logging.basicConfig(level=logging.ERROR)
    console = Console(stderr=True, quiet=chosen.quiet, log_path=False)
    try:
        with console.status("reading") as status:

            def progress(line: str) -> None:
                console.log(line, highlight=False)
                status.update(line)

            if chosen.thesis:
                from doormill_ros.thesis.run import run_thesis

                verdict = run_thesis(chosen.out)
            elif chosen.pictures is not None:
                from doormill_ros.diagnosis.camera.run import run_pictures

                verdict = run_pictures(chosen.pictures, chosen.out, progress)
            elif chosen.inspections is not None:
                from doormill_ros.diagnosis.parts.run import run_inspections

                verdict = run_inspections(chosen.inspections, chosen.out, progress)
            else:
                from doormill_ros.diagnosis.kinds import choose_runner

                run = choose_runner([*chosen.data, *chosen.check])
                verdict = run(chosen.data, chosen.check, chosen.out, progress)
    except DoormillError as error:
        print(" ".join(error.message.split()), file=sys.stderr)
        return 2
    print(verdict)
    return 0


if __name__ == "__main__":
    sys.exit(main())
