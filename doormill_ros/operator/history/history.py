"""Ended runs that outlive the page: a line each in a file, and the summaries of single runs beside it."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.state import HISTORY

FILE = "history.jsonl"
SUMMARIES = ("summary.json", "*/summary.json")
MOST_READ = 16_000_000  # bytes of the file, its newest
RECENT = 1_000_000  # bytes, of which the last runs are
MOST_SUMMARIES = 1000
_LATEST = 253402300800.0  # s since the epoch, the beginning of the year 10000
_UNREADABLE = (ValueError, KeyError, TypeError, OverflowError, RecursionError)


def load_history(folder: Path) -> tuple[EndedRun, ...]:
    """The last runs that ended, the newest first; what cannot be read is passed over.

    Args:
        folder: Where `append_history` wrote, or with the output folders of single runs in it.
    """
    found: dict[str, EndedRun] = {}
    for path in (path for pattern in SUMMARIES for path in folder.glob(pattern)):
        run = _summary(path)
        if run is not None:
            found[run.run_id] = run
    # A run that was measured later has a line more.
    for line in _last_lines(folder / FILE, RECENT)[0]:
        run = _run(line)
        if run is not None:
            found[run.run_id] = run
    return tuple(sorted(found.values(), key=lambda run: run.ended, reverse=True)[:HISTORY])


@dataclass(frozen=True)
class Kept:
    """Runs of a folder; `whole`: all of them."""

    runs: tuple[EndedRun, ...] = ()
    whole: bool = True


def kept_runs(folder: Path | None, most: int = MOST_READ) -> Kept:
    """All runs that ended, in the order of the file, each once; what cannot be read is passed over.

    Args:
        folder: As in `load_history`; None holds nothing.
        most: The file's last bytes that are read [bytes].
    """
    if folder is None:
        return Kept()
    paths = (path for pattern in SUMMARIES for path in folder.glob(pattern))
    single = list(islice(paths, MOST_SUMMARIES + 1))
    lines, whole = _last_lines(folder / FILE, most)
    runs = (*map(_summary, single[:MOST_SUMMARIES]), *map(_run, lines))
    found = {run.run_id: run for run in runs if run is not None}
    return Kept(tuple(found.values()), whole and len(single) <= MOST_SUMMARIES)


def kept_run(folder: Path, run_id: str) -> EndedRun | None:
    """What the file says of a run last; None where it does not know it.

    Args:
        folder: Where `append_history` wrote.
        run_id: Of the run.
    """
    written = json.dumps(run_id)
    runs = (_run(line) for line in reversed(_last_lines(folder / FILE, MOST_READ)[0]) if written in line)
    return next((run for run in runs if run is not None and run.run_id == run_id), None)


def _last_lines(path: Path, most: int) -> tuple[list[str], bool]:
    """Lines of a file, and whether they are all; a line that begins before its last bytes is none."""
    try:
        with path.open("rb") as stream:
            begin = max(path.stat().st_size - most, 0)
            stream.seek(begin)
            lines = stream.read(most).split(b"\n")
    except OSError:
        return [], True
    return [line.decode("utf-8", "replace") for line in lines[1 if begin else 0 :]], begin == 0


def append_history(folder: Path, run: EndedRun) -> None:
    """Add a run.

    Raises:
        OSError: The file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(asdict(run)) + "\n")


def _run(line: str) -> EndedRun | None:
    try:
        return _ended(json.loads(line))
    except _UNREADABLE:
        return None


def _summary(path: Path) -> EndedRun | None:
    """A run from its summary.json, which says how but not when it ended: the file's time does."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        return _ended({**document, "ended": path.stat().st_mtime})
    except (OSError, *_UNREADABLE):
        return None


def _ended(values: dict[str, Any]) -> EndedRun:
    run = EndedRun(
        run_id=str(values["run_id"]),
        door_id=str(values["door_id"]),
        success=bool(values["success"]),
        error_code=int(values["error_code"]),
        message=str(values["message"]),
        ended=float(values["ended"]),
        measured=bool(values.get("measured", False)),
        # Summaries are of simulated cells, which measure; lines of older software do not tell.
        in_cell=bool(values.get("in_cell", values.get("measured", False))),
        gauged=float(values.get("gauged", 0.0)),
    )
    if not run.run_id:
        raise ValueError("a goal that never became a run")
    if not (0.0 <= run.ended < _LATEST and 0.0 <= run.gauged < _LATEST):
        raise ValueError("a time that no calendar has")
    return run
