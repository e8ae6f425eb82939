"""What workers are asked in tests; a module of its own, so that they can import it."""

from __future__ import annotations

import os
import signal
import threading
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.recipes.errors import UnknownDoor


@dataclass(frozen=True)
class Task:
    """What a worker does.

    Attributes:
        number: Squared.
        folder: Where workers leave their marks.
        deaths: How many workers end as if the power went.
        ending: What becomes of it otherwise.
    """

    number: int
    folder: Path
    deaths: int = 0
    ending: str = ""

    def __str__(self) -> str:
        return f"task {self.number}"


def square(task: Task) -> object:
    marks = task.folder / str(task.number)
    marks.mkdir(exist_ok=True)
    tries = len(list(marks.iterdir()))
    (marks / str(tries)).touch()
    if tries < task.deaths:
        os.kill(os.getpid(), signal.SIGKILL)
    if task.ending == "refused":
        raise UnknownDoor("found no such door; ask for another")
    if task.ending == "broken":
        raise ValueError("something else")
    if task.ending == "exit":
        raise SystemExit(3)
    if task.ending == "hang":
        threading.Event().wait()
    if task.ending == "lambda":
        return lambda: None
    return task.number**2
