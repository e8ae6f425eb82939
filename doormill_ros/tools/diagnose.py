"""Tell what a simulation gets wrong: `diagnose --data DIR [--data DIR ...] [--check DIR ...] --out OUT`.

`--data` takes every kind of set by the schema in its set.yaml; some kinds have an option of their own, too. With
`--thesis` in place of `--data` it questions the thesis' own loading tests (tables 4.2 and 4.3).
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.runs.limits import MOST
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible

SPRINGS = "springs"  #: for --in-use: no model.yaml, the robot's own springs


@interruptible
def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tool; 0 for every verdict, 2 for data that cannot be read and results that cannot be written."""
    parser = argparse.ArgumentParser(prog="diagnose", description=__doc__)
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--data", metavar="DIR", type=Path, action="append", default=[], help="set to diagnose"
    )
    source.add_argument("--thesis", action="store_true", help="the loading tests that the thesis prints")
    own = {listed.option: listed for listed in kinds.KINDS if listed.option}
    for option, listed in own.items():
        source.add_argument(f"--{option}", metavar="DIR", type=Path, help=listed.help)
    parser.add_argument(
        "--check", metavar="DIR", type=Path, action="append", default=[], help="set to predict only"
    )
    parser.add_argument(
        "--in-use",
        metavar="MODEL",
        help="of --inspections: model.yaml that the next door is corrected with, to tell what it leaves; springs: none",
    )
    parser.add_argument(
        "--last",
        metavar="N",
        type=int,
        help="of --runs: the last runs only; bags that cannot be read are left aside and named",
    )
    parser.add_argument("--since", metavar="RUN", help="of --runs: the first run that counts")
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="folder for the results")
    parser.add_argument("--quiet", action="store_true", help="print the verdict only")
    chosen = parser.parse_args(arguments)
    if chosen.check and chosen.thesis:
        others = ", ".join(f"--{option}" for option in ("data", *own))
        parser.exit(
            2, f"diagnose: --check was given with --thesis, allowed is --check with {others}; leave one out\n"
        )
    if chosen.in_use is not None and chosen.inspections is None:
        parser.exit(2, "diagnose: --in-use was given without --inspections; leave it out\n")
    if chosen.runs is None and (chosen.last is not None or chosen.since is not None):
        parser.exit(2, "diagnose: --last or --since was given without --runs; leave it out\n")
    if chosen.last is not None and not 2 <= chosen.last <= MOST:
        parser.exit(2, f"diagnose: --last is {chosen.last}, allowed are 2 to {MOST}\n")
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
            else:
                from doormill_ros.diagnosis.core.kind import run  # late, as every kind (see `kinds`)

                named = [listed for option, listed in own.items() if getattr(chosen, option) is not None]
                asked = named[0] if named else kinds.kind_of([*chosen.data, *chosen.check])
                if chosen.in_use is not None:
                    kind = asked.make("" if chosen.in_use == SPRINGS else chosen.in_use)
                elif chosen.runs is not None:
                    kind = asked.make(chosen.last, chosen.since or "")
                else:
                    kind = asked.make()
                data = [getattr(chosen, asked.option)] if named else chosen.data
                verdict = run(kind, data, chosen.check, chosen.out, progress)
    except DoormillError as error:
        print(" ".join(error.message.split()), file=sys.stderr)
        return 2
    except OSError as error:
        print(
            f"diagnose: {error.filename or chosen.out} cannot be used, {error.strerror or error}; name another --out",
            file=sys.stderr,
        )
        return 2
    print(verdict)
    return 0


if __name__ == "__main__":
    sys.exit(main())
