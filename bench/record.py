"""Run a bench and keep what it prints: `python bench/record.py bench/worlds.py [ARGUMENTS]`.

`bench/results/NAME.txt` then holds command, date, commit and exit status of the run and its output; test/figures says
which figures of the pages are read from it. A bench that finds a bound missed ends with 1 and is kept all the
same, with that status; one that breaks off (an exception, a signal, nothing printed) is not.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

ROOT = Path(__file__).resolve().parents[1]
#: What names a site, or a part of it.
NAMED = ("DOORMILL_SITE", "DOORMILL_DATABASE", "DOORMILL_CATALOGUE")


def git(*arguments: str) -> str:
    """What git says of this repository."""
    return subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True
    ).stdout.strip()


def play(bench: str, rest: list[str], output: IO[str]) -> tuple[int, bool]:
    """Run a bench, its progress shown as it comes; its exit status, and whether it wrote of an exception.

    Recipes, catalogue and files of the site are its own, not the user's.
    """
    own = {name: value for name, value in os.environ.items() if name not in NAMED}
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder,
        subprocess.Popen(
            [sys.executable, bench, *rest],
            cwd=ROOT,
            env={**own, "XDG_DATA_HOME": folder},
            stdout=output,
            stderr=subprocess.PIPE,
            text=True,
        ) as process,
    ):
        assert process.stderr is not None
        raised = False
        for line in process.stderr:
            print(line, end="", file=sys.stderr)
            raised = raised or line.startswith("Traceback (most recent call last)")
    return process.returncode, raised


def main(arguments: list[str]) -> int:
    """Run, print, keep; the bench's exit status, and nothing is kept of one that broke off."""
    bench, *rest = arguments
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!bench/results")
    commit = git("rev-parse", "HEAD") + (" and changes that were not committed" if changed else "")
    begun = datetime.now(UTC)
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
        status, raised = play(bench, rest, output)
        output.seek(0)
        printed = output.read()
    print(printed, end="")
    if status not in (0, 1) or (status == 1 and raised) or not printed.strip():
        print(f"{bench} ended with {status}: nothing is kept", file=sys.stderr)
        return status or 1
    head = [
        f"command: python {' '.join([bench, *rest])}",
        f"date: {begun:%Y-%m-%d %H:%M} UTC",
        f"commit: {commit}",
        f"took: {(datetime.now(UTC) - begun).total_seconds():.0f} s",
        f"exit status: {status}",
    ]
    folder = ROOT / "bench" / "results"
    folder.mkdir(exist_ok=True)
    text = "\n".join(line.rstrip() for line in [*head, "", *printed.splitlines()])
    (folder / f"{Path(bench).stem}.txt").write_text(f"{text}\n", encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
