"""Hand bad files to readers: each is read, or refused in one sentence with a code, and nothing else happens.

Each kind of input is read in a process of its own, since a reader may end it, and with bounds on time and memory.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import random
import resource
import shutil
import signal
import tempfile
import traceback
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType

from doormill_ros.errors import DoormillError
from support.hostile.mutations import mutated
from support.hostile.subject import Subject

TIME = 10.0  #: of a processor for one reading [s]; a clock on the wall would judge the machine's load
MEMORY = 500 * 1024 * 1024  #: of one reading, beside what the process holds before [bytes]


@dataclass
class Outcome:
    """What became of the bad files of one subject.

    Attributes:
        answers: How often they were read, refused, or ended otherwise.
        faults: One sentence for each that ended otherwise: seed, what happened, where.
    """

    answers: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


class _TooLongError(BaseException):
    """Raised by the alarm; no reader can take it for an error of its own."""


def _ring(_number: int, _frame: FrameType | None) -> None:
    raise _TooLongError


def _inventory(folder: Path) -> Mapping[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*")}


def _answer(subject: Subject, folder: Path) -> tuple[str, str]:
    """What the reader says to the file that now stands in the folder: kind of answer and sentence."""
    before = _inventory(folder)
    signal.setitimer(signal.ITIMER_PROF, TIME)
    try:
        subject.read(folder / subject.file)
        kind, text = "read", ""
    except DoormillError as error:
        text = str(error)
        named = subject.file in text or str(folder) in text or not subject.named
        fine = error.code and named and "\n" not in text and 10 < len(text) < 2000
        kind = "refused" if fine else "a sentence without the file"
    except _TooLongError:
        kind, text = "longer than allowed", _place(traceback.format_exc())
    except MemoryError:
        kind, text = "more memory than allowed", _place(traceback.format_exc())
    except BaseException as error:  # whatever a reader lets through is what is looked for
        kind, text = type(error).__name__, f"{error!s:.200} {_place(traceback.format_exc())}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    if _inventory(folder) != before:
        kind = "changed files"
    return kind, text


def _place(trace: str) -> str:
    lines = [line.strip() for line in trace.splitlines() if "doormill_ros/" in line]
    return lines[-1] if lines else trace[-300:]


def _run(subject: Subject, seeds: range, pipe: Connection) -> None:
    # What this process inherited, nodes of other tests perhaps, whose threads are not here, is nobody's garbage.
    gc.freeze()
    gc.enable()
    signal.signal(signal.SIGPROF, _ring)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY, held + MEMORY))
    good = (subject.folder / subject.file).read_bytes()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "input"
        shutil.copytree(subject.folder, folder)
        for seed in seeds:
            pipe.send(("begins", seed, ""))
            draw = random.Random(f"{subject.name} {seed}")
            (folder / subject.file).write_bytes(mutated(good, draw))
            pipe.send((seed, *_answer(subject, folder)))


def judge(subject: Subject, seeds: range) -> Outcome:
    """Bad files of one subject, one for each seed."""
    outcome, last = Outcome(), seeds.start
    while last < seeds.stop:
        ours, theirs = multiprocessing.Pipe(duplex=False)
        process = multiprocessing.get_context("fork").Process(
            target=_run, args=(subject, range(last, seeds.stop), theirs)
        )
        gc.disable()
        process.start()
        gc.enable()
        theirs.close()
        for seed, kind, text in _received(ours):
            if seed == "begins":
                last = kind
                continue
            outcome.answers[kind if kind in ("read", "refused") else "fault"] += 1
            if kind not in ("read", "refused"):
                outcome.faults.append(f"{subject.name}, seed {seed}: {kind} {text}")
        process.join()
        if process.exitcode:
            outcome.answers["fault"] += 1
            outcome.faults.append(f"{subject.name}, seed {last}: the process ended with {process.exitcode}")
        last += 1
    return outcome


def _received(pipe: Connection) -> Iterator[tuple[object, str, str]]:
    try:
        while True:
            yield pipe.recv()
    except EOFError:
        return


def usable(subject: Subject) -> str:
    """Why the good input of a subject is not read; empty when it is."""
    try:
        subject.read(subject.folder / subject.file)
    except DoormillError as error:
        return str(error)
    return ""


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))
