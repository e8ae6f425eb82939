"""A test that stands still where no signal reaches it ends with its process and the stacks of its threads."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.source_tree import ROOT
from support.waiting import LIMIT

TESTS = {
    "in a call": (
        "def test_stands():\n    signal.signal(signal.SIGALRM, signal.SIG_IGN)\n    threading.Event().wait()\n"
    ),
    "after its limit": (
        "@pytest.fixture\ndef held():\n    yield\n    threading.Event().wait()\n\n"
        "def test_stands(held):\n    threading.Event().wait()\n"
    ),
}


@pytest.mark.parametrize("where", TESTS)
def test_its_process_ends(where: str, tmp_path: Path) -> None:
    conftest = (ROOT / "test" / "conftest.py").read_text(encoding="utf-8")
    assert "PATIENCE = 60.0" in conftest
    (tmp_path / "conftest.py").write_text(conftest.replace("PATIENCE = 60.0", "PATIENCE = 1.0"))
    (tmp_path / "pytest.ini").write_text("[pytest]\ntimeout = 1\n")
    head = "import signal\nimport threading\n\nimport pytest\n\n"
    (tmp_path / "test_it.py").write_text(f"{head}{TESTS[where]}")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "test_it.py"],
        cwd=tmp_path,
        # What the settings themselves need, and where a process that ends so leaves what it did not remove.
        env={**os.environ, "PYTHONPATH": str(ROOT / "test"), "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    assert done.returncode == 1, done.stdout
    assert "Timeout (0:00:02)!" in done.stderr
    assert "test_it.py" in done.stderr
