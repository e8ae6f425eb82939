"""What became of one file: read rightly, refused as it has to be, or a fault."""

from __future__ import annotations

import random
import shutil
import signal
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from doormill_ros.errors import LONGEST, DoormillError
from support.hostile.keeping import CannotSpellError, form_of, spelt_anew
from support.hostile.likeness import difference, essence
from support.hostile.places import good_keys, placed
from support.hostile.subject import Subject

TIME = 10.0  #: of a processor for one reading [s]; a clock on the wall would judge the machine's load
PLACED = ("yaml", "json", "csv", "xlsx")  #: forms of which a sentence has to say where


class TooLongError(BaseException):
    """Raised by the alarm; no reader can take it for an error of its own."""


def _inventory(place: Path) -> Mapping[Path, tuple[int, int]]:
    found = {path: path.lstat() for path in place.rglob("*")}
    return {path: (state.st_mtime_ns, state.st_size) for path, state in found.items()}


def _where(trace: str) -> str:
    lines = [line.strip() for line in trace.splitlines() if "doormill_ros/" in line]
    return lines[-1] if lines else trace[-300:]


def _header(content: bytes) -> bytes:
    return content.lstrip().split(b"\n", 1)[0].strip()


class Judge:
    """Reads files of one subject in a place where it would be seen that something was written.

    Args:
        subject: What is read.
        place: Holds the folder of the input, `input`, and those that the process takes for its own.
    """

    def __init__(self, subject: Subject, place: Path) -> None:
        self.subject, self.place = subject, place
        self.folder = place / "input"
        self.path = self.folder / subject.file
        self.form = form_of(subject.file) if subject.named else ""
        self.good = self.path.read_bytes()
        self._keys = good_keys(self.path, self.form) if self.form in ("yaml", "json") else set()
        self._value = essence(subject.read(self.path))

    def answer(self, content: bytes, kept: bool, draw: random.Random) -> tuple[str, str]:
        """What the reader makes of a content: kind of answer and sentence.

        Args:
            content: Put into the file.
            kept: Whether it says what the good file says.
            draw: For another spelling of what was read.
        """
        kind, text, value = self._reading(content)
        if kept:
            return self._same("the good file in another spelling", self._value, kind, text, value)
        if kind != "read":
            return kind, text
        try:
            found = essence(value)
        except (MemoryError, RecursionError, ValueError):  # read, and too much of it to be compared
            return kind, text
        kind, text = self._written_again(value, found)
        if kind == "read":
            kind, text = self._spelt_again(content, found, draw)
        return kind, text

    def _same(self, what: str, wanted: Any, kind: str, text: str, value: Any) -> tuple[str, str]:
        if kind != "read":
            return f"{what}: {kind}", text
        other = difference(wanted, essence(value))
        return (f"{what} is another", other) if other else ("read", "")

    def _written_again(self, value: Any, found: Any) -> tuple[str, str]:
        if self.subject.write is None:
            return "read", ""
        again = self.place.parent / "again"
        shutil.rmtree(again, ignore_errors=True)
        again.mkdir()
        path = again / self.subject.file
        try:
            self.subject.write(value, path)
            back = essence(self.subject.read(path))
        except Exception as error:  # whatever the writer or the reader says to what was read before
            return "read, not written again", f"{error!s:.300} {_where(traceback.format_exc())}"
        other = difference(found, back)
        return ("written again it is another", other) if other else ("read", "")

    def _spelt_again(self, content: bytes, found: Any, draw: random.Random) -> tuple[str, str]:
        if self.form == "csv" and _header(content) != _header(self.good):
            return "read", ""  # columns without their names go by their order
        try:
            other = spelt_anew(content, self.form, draw)
        except (CannotSpellError, MemoryError, RecursionError):
            return "read", ""
        return self._same("another spelling of it", found, *self._reading(other))

    def _reading(self, content: bytes) -> tuple[str, str, Any]:
        self.path.write_bytes(content)
        before = _inventory(self.place)
        answer = self._read()
        after = _inventory(self.place)
        if after != before:
            changed = sorted(
                {str(path.relative_to(self.place)) for path, _ in after.items() ^ before.items()}
            )
            return "changed files", ", ".join(changed[:3]), None
        return answer

    def _read(self) -> tuple[str, str, Any]:
        signal.setitimer(signal.ITIMER_PROF, TIME)
        try:
            return "read", "", self.subject.read(self.path)
        except DoormillError as error:
            return *self._refusal(error), None
        except TooLongError:
            return "longer than allowed", _where(traceback.format_exc()), None
        except MemoryError:
            return "more memory than allowed", _where(traceback.format_exc()), None
        except BaseException as error:  # whatever a reader lets through is what is looked for
            return type(error).__name__, f"{error!s:.200} {_where(traceback.format_exc())}", None
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)

    def _refusal(self, error: DoormillError) -> tuple[str, str]:
        subject, text = self.subject, str(error)
        if not error.code or "\n" in text or not 10 < len(text) <= LONGEST:
            return "no sentence", text
        if subject.named and subject.file not in text and str(self.folder) not in text:
            return "a sentence without the file", text
        if (
            self.form in PLACED
            and not subject.quiet
            and not placed(text, self.folder, subject.file, self._keys)
        ):
            return "a sentence without the place", text
        return "refused", text
