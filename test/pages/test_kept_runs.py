"""What a bench prints is kept when it ends by its own verdict, also of a bound that it misses, and never of a crash."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.source_tree import ROOT

ENDS = {
    "passed": ("print('12 doors, 0 wrong')", 0, True),
    "beyond": ("import sys; print('12 doors, 1 wrong'); sys.exit(1)", 1, True),
    "crashed": ("print('12 doors'); raise ValueError('a bench of two minds')", 1, False),
    "killed": ("import os; print('12 doors', flush=True); os.kill(os.getpid(), 9)", -9, False),
    "silent": ("pass", 0, False),
}


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A repository with the recorder of runs and a bench of each end."""
    bench = tmp_path / "clone" / "bench"
    bench.mkdir(parents=True)
    (bench / "record.py").write_text((ROOT / "bench" / "record.py").read_text(encoding="utf-8"))
    for name, (text, *_) in ENDS.items():
        (bench / f"{name}.py").write_text(f"{text}\n")
    author = {
        f"GIT_{who}_{what}": "bench@localhost"
        for who in ("AUTHOR", "COMMITTER")
        for what in ("NAME", "EMAIL")
    }
    for command in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "Benches"]):
        subprocess.run(["git", "-C", str(bench.parent), *command], check=True, env={**os.environ, **author})
    return bench.parent


@pytest.mark.parametrize("name", ENDS)
def test_a_run_is_kept_when_the_bench_came_to_a_verdict(clone: Path, name: str) -> None:
    _, status, stays = ENDS[name]
    command = [sys.executable, "bench/record.py", f"bench/{name}.py", "--doors", "12"]
    done = subprocess.run(command, cwd=clone, capture_output=True, text=True, check=False)
    assert done.returncode == (status % 256 if status else (0 if stays else 1))
    kept = clone / "bench" / "results" / f"{name}.txt"
    assert kept.exists() == stays
    if not stays:
        assert f"ended with {status}: nothing is kept" in done.stderr
        return
    head, _, printed = kept.read_text(encoding="utf-8").partition("\n\n")
    assert f"command: python bench/{name}.py --doors 12" in head.splitlines()
    assert f"exit status: {status}" in head.splitlines()
    assert printed.strip() == done.stdout.strip()
