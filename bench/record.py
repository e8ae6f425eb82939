"""Run a bench and keep what it prints: `python bench/record.py bench/worlds.py [ARGUMENTS]`.

`bench/results/NAME.txt` then holds command, date, commit and exit status of the run and its output; `test/figures.yaml`
says which figures of the pages are read from it.
"""

from __future__ import annotations

import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def git(*arguments: str) -> str:
    """What git says of this repository."""
    return subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True
    ).stdout.strip()


def main(arguments: list[str]) -> int:
    """Run, print, keep; the bench's exit status, and nothing is kept of one that failed."""
    bench, *rest = arguments
    changed = git("status", "--porcelain", "--untracked-files=no")
    commit = git("rev-parse", "HEAD") + (" and changes that were not committed" if changed else "")
    begun = datetime.now(UTC)
    done = subprocess.run(
        [sys.executable, bench, *rest], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False
    )
    print(done.stdout, end="")
    if done.returncode:
        print(f"{bench} ended with {done.returncode}: nothing is kept", file=sys.stderr)
        return done.returncode
    head = [
        f"command: python {' '.join([bench, *rest])}",
        f"date: {begun:%Y-%m-%d %H:%M} UTC",
        f"commit: {commit}",
        f"took: {(datetime.now(UTC) - begun).total_seconds():.0f} s",
    ]
    folder = ROOT / "bench" / "results"
    folder.mkdir(exist_ok=True)
    text = "\n".join(line.rstrip() for line in [*head, "", *done.stdout.splitlines()])
    (folder / f"{Path(bench).stem}.txt").write_text(f"{text}\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
