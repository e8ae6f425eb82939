"""Hand bad files to readers: each is read rightly, or refused in one sentence with a code, and nothing else happens.

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
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType

from doormill_ros.errors import DoormillError
from support.hostile.judge import Judge, TooLongError
from support.hostile.keeping import CannotSpellError, spelt_anew
from support.hostile.mutations import mutated
from support.hostile.subject import Subject
from support.hostile.workbook import mutated_inside

MEMORY = 500 * 1024 * 1024  #: of one reading, beside what the process holds before [bytes]
KEPT = 0.15  #: of the files are the good one in another spelling
INSIDE = 0.8  #: of the bad workbooks are whole archives
OWN = (
    "HOME",
    "TMPDIR",
    "XDG_CACHE_HOME",
    "XDG_DATA_HOME",
    "XDG_CONFIG_HOME",
    "XDG_STATE_HOME",
    "ROS_LOG_DIR",
)


@dataclass
class Outcome:
    """What became of the bad files of one subject.

    Attributes:
        answers: How often they were read, refused, or ended otherwise.
        faults: One sentence for each that ended otherwise: seed, what happened, where.
    """

    answers: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


def _ring(_number: int, _frame: FrameType | None) -> None:
    raise TooLongError


def _settle(place: Path) -> None:
    """Let this process take folders of that place for its own: where it is, at home, for what lasts no longer."""
    for name in OWN:
        (place / name).mkdir()
        os.environ[name] = str(place / name)
    (place / "cwd").mkdir()
    os.chdir(place / "cwd")
    tempfile.tempdir = str(place / "TMPDIR")


def _content(judge: Judge, draw: random.Random) -> tuple[bytes, bool]:
    """Content for the next reading, and whether it says what the good file says."""
    if draw.random() < KEPT:
        try:
            return spelt_anew(judge.good, judge.form, draw), True
        except CannotSpellError:
            pass
    if judge.form == "xlsx" and draw.random() < INSIDE:
        return mutated_inside(judge.good, draw), False
    return mutated(judge.good, draw), False


def _run(subject: Subject, seeds: range, stem: str, pipe: Connection) -> None:
    # What this process inherited, nodes of other tests perhaps, whose threads are not here, is nobody's garbage.
    gc.freeze()
    gc.enable()
    signal.signal(signal.SIGPROF, _ring)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name) / "place"
        shutil.copytree(subject.folder, place / "input")
        _settle(place)
        judge = Judge(subject, place)
        held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY, held + MEMORY))
        for seed in seeds:
            pipe.send(("begins", seed, ""))
            draw = random.Random(f"{stem}{subject.name} {seed}")
            content, kept = _content(judge, draw)
            pipe.send((seed, *judge.answer(content, kept, draw)))


def judge(subject: Subject, seeds: range, stem: str = "") -> Outcome:
    """Bad files of one subject, one for each seed; another stem makes others of the same seeds."""
    outcome, last = Outcome(), seeds.start
    while last < seeds.stop:
        ours, theirs = multiprocessing.Pipe(duplex=False)
        process = multiprocessing.get_context("fork").Process(
            target=_run, args=(subject, range(last, seeds.stop), stem, theirs)
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
                outcome.faults.append(f"{subject.name}, seed {seed}: {kind}: {text}")
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
