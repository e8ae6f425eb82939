"""expected.yaml in a bag's folder: answers that count instead of the recorded ones.

`replay --update` writes it when a change of the code is meant; without it, what was recorded counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from doormill_ros.config import read
from doormill_ros.files import write_atomically
from doormill_ros.recording.errors import BadExpectationError
from doormill_ros.recording.replay.answer import Answer, stage_of
from doormill_ros.values import Exactly, Section
from doormill_ros.yaml_text import text_of

SCHEMA = "doormill/expected/1"
FILE = "expected.yaml"

Answers = Mapping[str, Sequence[Answer]]  # by run id


@dataclass(frozen=True)
class _Answer(Section):
    topic: str
    stamp_ns: int
    values: dict[str, Any]


@dataclass(frozen=True)
class _Expectation(Section):
    schema: Annotated[str, Exactly(SCHEMA)]
    runs: dict[str, list[_Answer]]


def read_expectation(bag: Path) -> dict[str, list[Answer]] | None:
    """Answers by run id; None when the bag has no expected.yaml.

    Raises:
        BadExpectationError: The file is not of the form that `write_expectation` gives it.
    """
    path = bag / FILE
    if not path.exists():
        return None
    content = read(path, _Expectation, BadExpectationError, "remove it or write it anew with replay --update")
    return {
        run_id: [Answer(a.topic, a.stamp_ns, a.values) for a in answers]
        for run_id, answers in content.runs.items()
        if all(stage_of(a.topic) for a in answers)
    }


def write_expectation(bag: Path, answers: Answers) -> Path:
    """Write expected.yaml; returns its path."""
    runs: dict[str, Any] = {
        run_id: [{"topic": a.topic, "stamp_ns": a.stamp_ns, "values": a.values} for a in of_run]
        for run_id, of_run in answers.items()
    }
    path = bag / FILE
    document = {"schema": SCHEMA, "runs": runs}
    write_atomically(path, text_of(document, width=4096))
    return path
