"""Asks the diagnosis in a process of its own, one question at a time; of waiting ones of a kind the newest counts."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from doormill_ros.errors import one_line
from doormill_ros.files import write_atomically
from doormill_ros.monitor.question import DiagnosisAnswer, DiagnosisQuestion
from doormill_ros.robot_model.model_file import MODEL_FILE

#: Behind the running cell: the door comes first.
NICE = ("nice", "-n", "10")
PROGRAM = "doormill_ros.tools.diagnose"
QUESTION, NEW, DOCUMENT, ASKED = "question", ".new", "diagnosis.json", "asked.json"
STOP_LIMIT = 5.0  # s
_LOOK = 0.1  # s


class Questioner:
    """Asks one question at a time, in the order in which their kinds came.

    Args:
        folder: For what is asked and answered; the last answers stay in it.
        limit: Seconds that a diagnosis may take, asked each time.
    """

    def __init__(self, folder: Path, limit: Callable[[], float]) -> None:
        self._folder = folder
        self._limit = limit
        self._changed = threading.Condition()
        self._told: dict[
            type[DiagnosisQuestion], tuple[Callable[[DiagnosisAnswer], None], Callable[[], None]]
        ] = {}
        self._waiting: dict[type[DiagnosisQuestion], DiagnosisQuestion] = {}
        self._in_hand: type[DiagnosisQuestion] | None = None
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="questioner", daemon=True)

    def tell(
        self,
        kind: type[DiagnosisQuestion],
        answered: Callable[[DiagnosisAnswer], None],
        changed: Callable[[], None],
    ) -> None:
        """Whom to tell of the answers to questions of a kind.

        Args:
            kind: Of question.
            answered: Called with every answer from the questioner's thread.
            changed: Called after that, when what follows of it is known.
        """
        self._told[kind] = answered, changed

    def asking(self, kind: type[DiagnosisQuestion]) -> bool:
        """A question of a kind waits for its answer."""
        return self._in_hand is kind or kind in self._waiting

    def start(self) -> None:
        """Begin to ask."""
        self._thread.start()

    def ask(self, question: DiagnosisQuestion) -> None:
        """Ask as soon as those before it are answered; takes the place of one of its kind that waits."""
        with self._changed:
            self._waiting[type(question)] = question
            self._changed.notify_all()

    def stop(self) -> None:
        """Ask no more; the diagnosis in hand is ended."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)

    def last(self, kind: type[DiagnosisQuestion]) -> DiagnosisAnswer | None:
        """The last answer of a kind, also that of an earlier process; None where there is none."""
        return _read(self._folder / kind.kept, kind)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or self._waiting)
                if self._ended:
                    return
                kind = next(iter(self._waiting))
                self._in_hand = kind  # first: who looks without the lock shall see no moment of rest
                question = self._waiting.pop(kind)
            answered, changed = self._told[kind]
            try:
                answer = self._answer(question)
            except OSError as error:
                answer = DiagnosisAnswer(question.asked, failure=f"the diagnosis cannot be asked: {error}")
            if not self._ended:
                answered(answer)  # asking until what follows of it is known
            self._in_hand = None
            if not self._ended:
                changed()

    def _answer(self, question: DiagnosisQuestion) -> DiagnosisAnswer:
        kept = self._folder / question.kept
        laid, out = self._folder / QUESTION, self._folder / f"{question.kept}{NEW}"
        for folder in (laid, out):
            shutil.rmtree(folder, ignore_errors=True)
        laid.mkdir(parents=True)
        failure = self._call([*question.lay_out(laid), "--out", str(out), "--quiet"])
        if failure:
            return DiagnosisAnswer(question.asked, failure=failure)
        write_atomically(out / ASKED, json.dumps(question.asked) + "\n")
        shutil.rmtree(kept, ignore_errors=True)
        os.replace(out, kept)
        return _read(kept, type(question)) or DiagnosisAnswer(
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
            return (
                f"the diagnosis took longer than {self._limit():g} s and was ended; let fewer be questioned"
            )
        if process.returncode:
            said = errors.read_text(encoding="utf-8", errors="replace").strip()
            return one_line(said) or f"the diagnosis ended with status {process.returncode}"
        return ""


def _read(folder: Path, kind: type[DiagnosisQuestion]) -> DiagnosisAnswer | None:
    try:
        asked = json.loads((folder / ASKED).read_text(encoding="utf-8"))
        document = json.loads((folder / DOCUMENT).read_text(encoding="utf-8"))
        model = (folder / MODEL_FILE).read_bytes() if kind.leaves_model else b""
        return DiagnosisAnswer(asked, document, model) if kind.is_asked(asked) else None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
