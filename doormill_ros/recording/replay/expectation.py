"""expected.yaml in a bag's folder: answers that count instead of the recorded ones.

`replay --update` writes it when a change of the code is meant; without it, what was recorded counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.files import write_atomically
from doormill_ros.recording.errors import BadExpectationError
from doormill_ros.recording.replay.answer import STAGES, Answer

SCHEMA = "doormill/expected/1"
FILE = "expected.yaml"
_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_Dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)

Answers = Mapping[str, Sequence[Answer]]  # by run id


def read_expectation(bag: Path) -> dict[str, list[Answer]] | None:
    """Answers by run id; None when the bag has no expected.yaml.

    Raises:
        BadExpectationError: The file is not of the form that `write_expectation` gives it.
    """
    path = bag / FILE
    if not path.exists():
        return None
    try:
        document = yaml.load(path.read_text(encoding="utf-8"), _Loader)
        if document["schema"] != SCHEMA:
            raise KeyError(f"schema {document['schema']!r} instead of {SCHEMA!r}")
        return {
            run_id: [Answer(a["topic"], int(a["stamp_ns"]), dict(a["values"])) for a in answers]
            for run_id, answers in document["runs"].items()
            if all(a["topic"] in STAGES for a in answers)
        }
    except (
        OSError,
        UnicodeDecodeError,
        yaml.YAMLError,
        KeyError,
        TypeError,
        ValueError,
        AttributeError,
    ) as error:
        raise BadExpectationError(
            f"{path} is no expectation of a replay: {error}; remove it or write it anew with replay --update",
            path=str(path),
        ) from error


def write_expectation(bag: Path, answers: Answers) -> Path:
    """Write expected.yaml; returns its path."""
    runs: dict[str, Any] = {
        run_id: [{"topic": a.topic, "stamp_ns": a.stamp_ns, "values": a.values} for a in of_run]
        for run_id, of_run in answers.items()
    }
    path = bag / FILE
    document = {"schema": SCHEMA, "runs": runs}
    write_atomically(path, yaml.dump(document, Dumper=_Dumper, sort_keys=False, width=4096))
    return path
