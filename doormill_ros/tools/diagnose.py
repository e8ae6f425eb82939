"""Tell what a simulation gets wrong: `diagnose --data DIR [--data DIR ...] [--check DIR ...] --out OUT`.

`--data` takes every kind of set by the schema in its set.yaml; some kinds have an option of their own, too. With
`--thesis` in place of `--data` it questions the thesis' own loading tests (tables 4.2 and 4.3).
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.console import Console

from doormill_ros.diagnosis import kinds
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser


@interruptible
def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tool; 0 for every verdict, 2 for data that cannot be read and results that cannot be written."""
    parser = _parser()
    chosen = parser.parse_args(arguments)
    refused = _refusal(chosen)
    if refused is not None:
        parser.error(refused)
    logging.basicConfig(level=logging.ERROR)
    console = Console(stderr=True, quiet=chosen.quiet, log_path=False)
    try:
        with console.status("reading") as status:

            def progress(line: str) -> None:
                console.log(line, highlight=False)
                status.update(line)

            verdict = _verdict(chosen, progress)
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


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(prog="diagnose", description=__doc__)
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--data", metavar="DIR", type=Path, action="append", default=[], help="set to diagnose"
    )
    source.add_argument("--thesis", action="store_true", help="the loading tests that the thesis prints")
    for listed in kinds.KINDS:
        listed.add_option(source)
    parser.add_argument(
        "--check", metavar="DIR", type=Path, action="append", default=[], help="set to predict only"
    )
    for listed in kinds.KINDS:
        listed.add_further(parser)
    parser.add_argument("--out", metavar="OUT", type=Path, required=True, help="folder for the results")
    parser.add_argument("--quiet", action="store_true", help="print the verdict only")
    return parser


def _refusal(chosen: argparse.Namespace) -> str | None:
    """Why options do not go together, None where they do."""
    if chosen.check and chosen.thesis:
        own = [listed.option for listed in kinds.KINDS if listed.option]
        others = ", ".join(f"--{option}" for option in ("data", *own))
        return f"--check was given with --thesis, allowed is --check with {others}; leave one out"
    refusals = (listed.refusal(chosen) for listed in kinds.KINDS)
    return next((refusal for refusal in refusals if refusal is not None), None)


def _verdict(chosen: argparse.Namespace, progress: Callable[[str], None]) -> str:
    """Diagnose what was chosen; the verdict in one line."""
    if chosen.thesis:
        from doormill_ros.thesis.run import run_thesis

        return run_thesis(chosen.out)
    from doormill_ros.diagnosis.core.kind import run  # late, as every kind (see `kinds`)

    named = [(listed, folder) for listed in kinds.KINDS if (folder := listed.folder(chosen)) is not None]
    data = [folder for _, folder in named] or chosen.data
    asked = named[0][0] if named else kinds.kind_of([*data, *chosen.check])
    return run(asked.made(chosen), data, chosen.check, chosen.out, progress)


if __name__ == "__main__":
    sys.exit(main())
