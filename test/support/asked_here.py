"""The diagnosis asked in this process, for tests of what is asked when, and of what an answer comes to.

A process of its own, as a cell asks it, costs more than a small diagnosis itself; each module that asks here has tests
that ask there, too.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from doormill_ros.errors import one_line
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.tools.diagnose import main


class AskedHere(Questioner):
    """Calls the tool that the other starts, and has the same to say of a failure."""

    def _call(self, arguments: Sequence[str]) -> str:
        errors = io.StringIO()
        with redirect_stdout(io.StringIO()), redirect_stderr(errors):
            status = main(list(arguments))
        return one_line(errors.getvalue().strip()) or f"status {status}" if status else ""


def questioner(folder: Path, limit: Callable[[], float], own_process: bool) -> Questioner:
    """One that asks in a process of its own, or here."""
    return Questioner(folder, limit) if own_process else AskedHere(folder, limit)
