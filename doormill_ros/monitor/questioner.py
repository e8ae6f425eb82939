"""Asks the diagnosis about inspected doors in a process of its own; of waiting questions the newest counts."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from doormill_ros.errors import one_line
from doormill_ros.files import write_atomically
from doormill_ros.measurements.inspection import DESCRIPTION, TABLE
from doormill_ros.robot_model.model_file import MODEL_FILE

#: Behind the running cell: the door comes first.
NICE = ("nice", "-n", "10")
PROGRAM = "doormill_ros.tools.diagnose"
SPRINGS = "springs"  #: what the tool calls the robot's own springs
QUESTION, ANSWER, DOCUMENT, ASKED = "question", "answer", "diagnosis.json", "asked.json"
STOP_LIMIT = 5.0  # s
_LOOK = 0.1  # s


@dataclass(frozen=True)
class DoorQuestion:
    """What the diagnosis is asked.

    Attributes:
        doors: Folders of inspections by run, oldest first.
        version: Of the model in use.
        model: Its path; "" for the robot's joint springs.
        checksums: Of what was measured on each door, see `checksum`; taken before the diagnosis reads it.
    """

    doors: tuple[tuple[str, Path], ...]
    version: int
    model: str
    checksums: tuple[str, ...] = ()

    @property
    def asked(self) -> dict[str, Any]:
        """What tells it from others, JSON-able."""
        return {
            "runs": [run_id for run_id, _ in self.doors],
            "checksums": [*self.checksums],
            "version": self.version,
            "model": self.model,
        }


def checksum(inspection: Path) -> str:
    """Of both files of an inspection: SHA-256; empty where they are not there."""
    whole = hashlib.sha256()
    try:
        for name in (DESCRIPTION, TABLE):
            with (inspection / name).open("rb") as stream:
                whole.update(hashlib.file_digest(stream, "sha256").digest())
    except OSError:
        return ""  # measured anew or set aside at this moment: the question after it has another one
    return whole.hexdigest()


@dataclass(frozen=True, eq=False)
class DoorAnswer:
    """What the diagnosis answered.

    Attributes:
        asked: As `DoorQuestion.asked`.
        document: Content of diagnosis.json; None where there is none.
        model: Content of model.yaml.
        failure: Why there is none, empty when there is.
    """

    asked: dict[str, Any]
    document: dict[str, Any] | None = None
    model: bytes = b""
    failure: str = ""


class Questioner:
    """Asks one question at a time.

    Args:
        folder: For what is asked and answered; the last answer stays in `answer`.
        answered: Called with every verdict from the questioner's thread.
        changed: Called after that, when nothing more is asked for the moment.
        limit: Seconds that a diagnosis may take, asked each time.
    """

    def __init__(
        self,
        folder: Path,
        answered: Callable[[DoorAnswer], None],
        changed: Callable[[], None],
        limit: Callable[[], float],
    ) -> None:
        self._folder = folder
        self._answered = answered
        self._changed_state = changed
        self._limit = limit
        self._changed = threading.Condition()
        self._next: DoorQuestion | None = None
        self._busy = self._ended = False
        self._thread = threading.Thread(target=self._run, name="questioner", daemon=True)

    @property
    def asking(self) -> bool:
        """A question waits for its answer."""
        return self._busy or self._next is not None

    def start(self) -> None:
        """Begin to ask."""
        self._thread.start()

    def ask(self, question: DoorQuestion) -> None:
        """Ask as soon as the question in hand is answered; takes the place of one that waits."""
        with self._changed:
            self._next = question
            self._changed.notify_all()

    def stop(self) -> None:
        """Ask no more; the diagnosis in hand is ended."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)

    def last(self) -> DoorAnswer | None:
        """The last answer, also that of an earlier process; None where there is none."""
        return _read(self._folder / ANSWER)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._next is not None)
                if self._ended or self._next is None:
                    return
                self._busy = True  # first: who looks without the lock shall see no moment of rest
                question, self._next = self._next, None
            try:
                verdict = self._answer(question)
            except OSError as error:
                verdict = DoorAnswer(question.asked, failure=f"the diagnosis cannot be asked: {error}")
            if not self._ended:
                self._answered(verdict)  # asking until what follows of it is known
            self._busy = False
            if not self._ended:
                self._changed_state()

    def _answer(self, question: DoorQuestion) -> DoorAnswer:
        asked, out = self._folder / QUESTION, self._folder / f"{ANSWER}.new"
        for folder in (asked, out):
            shutil.rmtree(folder, ignore_errors=True)
        asked.mkdir(parents=True)
        for run_id, folder in question.doors:
            (asked / run_id).symlink_to(folder.resolve())
        command = [
            "--inspections",
            str(asked),
            "--in-use",
            question.model or SPRINGS,
            "--out",
            str(out),
            "--quiet",
        ]
        failure = self._call(command)
        if failure:
            return DoorAnswer(question.asked, failure=failure)
        write_atomically(out / ASKED, json.dumps(question.asked) + "\n")
        shutil.rmtree(self._folder / ANSWER, ignore_errors=True)
        os.replace(out, self._folder / ANSWER)
        return _read(self._folder / ANSWER) or DoorAnswer(
            question.asked, failure="the diagnosis left nothing readable"
        )

    def _call(self, arguments: Sequence[str]) -> str:
        """Run the tool; why it left nothing, empty when it did its work."""
        errors = self._folder / "errors.txt"
        # What this process can import, the other one has to.
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        with errors.open("wb") as stream:
            process = subprocess.Popen(
                [*NICE, sys.executable, "-m", PROGRAM, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stream,
                env=environment,
                start_new_session=True,  # an interrupt from the terminal is this process' to pass on
            )
        deadline = time.monotonic() + self._limit()
        try:
            while process.poll() is None and not self._ended and time.monotonic() < deadline:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(_LOOK)
            late = process.poll() is None
        finally:
            process.kill()
            process.wait()
        if late:
            return f"the diagnosis took longer than {self._limit():g} s and was ended; let fewer doors be questioned"
        if process.returncode:
            said = errors.read_text(encoding="utf-8", errors="replace").strip()
            return one_line(said) or f"the diagnosis ended with status {process.returncode}"
        return ""


def _read(folder: Path) -> DoorAnswer | None:
    try:
        asked = json.loads((folder / ASKED).read_text(encoding="utf-8"))
        document = json.loads((folder / DOCUMENT).read_text(encoding="utf-8"))
        runs, version, model = asked["runs"], asked["version"], asked["model"]
        answer = DoorAnswer(asked, document, (folder / MODEL_FILE).read_bytes())
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    named = isinstance(runs, list) and bool(runs) and all(isinstance(run, str) for run in runs)
    return answer if named and isinstance(version, int) and isinstance(model, str) else None
