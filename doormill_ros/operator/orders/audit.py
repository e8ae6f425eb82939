"""Who ordered what at the operator's page and what came of it: lines of JSON in files that are rotated."""

from __future__ import annotations

import json
import os
import threading
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from doormill_ros.operator.errors import AuditError

#: Orders of who has a token, and tries of who has none: those who try cannot push orders out of the log.
ORDERS, REFUSED = "orders.jsonl", "refused.jsonl"
LARGEST = 1_000_000  # bytes of a file
KEPT = 9  # full files beside the one that is written, of each kind
LONGEST_TEXT = 500  # characters


@dataclass(frozen=True)
class AuditEntry:
    """One order or try.

    Attributes:
        time: When it was answered, UTC, ISO 8601.
        role: Role of the token it came with; "look" when it came with none of the tokens.
        who: Name of the person whose token it is; empty where a role has one token for all.
        address: Where it came from.
        order: Method and path, without what stands behind a question mark.
        door_id: The door it is about, empty when about none or when nobody looked.
        outcome: "accepted" or "refused".
        status: Status of the answer.
        message: The sentence that was answered.
    """

    time: str
    role: str
    who: str
    address: str
    order: str
    door_id: str
    outcome: str
    status: int
    message: str


class AuditLog:
    """The files in a folder; used from any thread.

    Args:
        folder: Made when the first line is written.
        largest: A file that would grow beyond this becomes `NAME.1`, what was that `NAME.2` [bytes].
        kept: Full files that are kept.
    """

    def __init__(self, folder: Path, largest: int = LARGEST, kept: int = KEPT) -> None:
        self._folder = folder
        self._largest = largest
        self._kept = kept
        self._lock = threading.Lock()

    def require(self) -> None:
        """Make sure that an order can be written down before it is carried out.

        Raises:
            AuditError: It cannot.
        """
        with self._lock, self._opened(ORDERS):
            pass

    def write(self, entry: AuditEntry, known: bool) -> None:
        """Add a line.

        Args:
            entry: The order.
            known: It came with one of the tokens.

        Raises:
            AuditError: It cannot be written.
        """
        values = {k: v[:LONGEST_TEXT] if isinstance(v, str) else v for k, v in asdict(entry).items()}
        line = json.dumps(values).encode() + b"\n"
        name = ORDERS if known else REFUSED
        with self._lock, self._opened(name, len(line)) as file:
            if os.write(file, line) != len(line):
                raise OSError("the disk is full")

    def last(self, number: int) -> list[dict[str, Any]]:
        """The last lines of the two newest files of either kind, the newest first."""
        found: list[dict[str, Any]] = []
        with self._lock:
            for name in (ORDERS, REFUSED):
                for path in (self._folder / f"{name}.1", self._folder / name):
                    found += _read(path, number)
        return sorted(found, key=lambda entry: str(entry.get("time")), reverse=True)[:number]

    @contextmanager
    def _opened(self, name: str, more: int = 0) -> Iterator[int]:
        path = self._folder / name
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._rotate(path, more)
            file = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o640)
            try:
                yield file
            finally:
                os.close(file)
        except OSError as error:
            raise AuditError(
                f"the audit log {path} cannot be written: {error.strerror or error}; without it no run is started: "
                "make room there, or choose another folder with the parameter audit of /operator_page",
                path=str(path),
            ) from error

    def _rotate(self, path: Path, more: int) -> None:
        with suppress(FileNotFoundError):
            if path.stat().st_size + more <= self._largest:
                return
            for number in range(self._kept - 1, 0, -1):
                with suppress(FileNotFoundError):
                    os.replace(f"{path}.{number}", f"{path}.{number + 1}")
            os.replace(path, f"{path}.1")


def _read(path: Path, number: int) -> list[dict[str, Any]]:
    entries = []
    try:
        with path.open(encoding="utf-8", errors="replace") as stream:
            lines = deque(stream, maxlen=number)
    except OSError:
        return []
    for line in lines:
        with suppress(ValueError, RecursionError):  # a line that a power cut left
            entries.append(json.loads(line))
    return [entry for entry in entries if isinstance(entry, dict)]
