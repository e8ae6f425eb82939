"""What inspected doors are asked: whether the robot is as its model says."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from doormill_ros.cell.output.inspection_files import DESCRIPTION, TABLE
from doormill_ros.diagnosis.kinds import SPRINGS
from doormill_ros.monitor.question import DiagnosisQuestion


@dataclass(frozen=True)
class DoorQuestion(DiagnosisQuestion):
    """Inspected doors and the model in use.

    Attributes:
        doors: Folders of inspections by run, oldest first.
        version: Of the model in use.
        model: Its path; "" for the robot's joint springs.
        checksums: Of what was measured on each door, see `checksum`; taken before the diagnosis reads it.
    """

    kept = "answer"
    leaves_model = True

    doors: tuple[tuple[str, Path], ...]
    version: int
    model: str
    checksums: tuple[str, ...] = ()

    @property
    def asked(self) -> dict[str, Any]:
        """Runs with the checksums of what was measured, and the model."""
        return {
            "runs": [run_id for run_id, _ in self.doors],
            "checksums": [*self.checksums],
            "version": self.version,
            "model": self.model,
        }

    @staticmethod
    def is_asked(asked: Any) -> bool:
        """Some runs, a version and a path."""
        runs, version, model = asked["runs"], asked["version"], asked["model"]
        named = isinstance(runs, list) and bool(runs) and all(isinstance(run, str) for run in runs)
        return named and isinstance(version, int) and isinstance(model, str)

    def lay_out(self, folder: Path) -> Sequence[str]:
        """A link to each inspection."""
        for run_id, door in self.doors:
            (folder / run_id).symlink_to(door.resolve())
        return ["--inspections", str(folder), "--in-use", self.model or SPRINGS]


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
