"""A question to the diagnosis, and its answer; each kind of question keeps its last answer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar


class DiagnosisQuestion(ABC):
    """What the diagnosis is asked.

    Attributes:
        kept: Folder of the last answer of this kind, below that of the questioner.
        leaves_model: Whether an answer holds a model.
    """

    kept: ClassVar[str]
    leaves_model: ClassVar[bool] = False

    @property
    @abstractmethod
    def asked(self) -> dict[str, Any]:
        """What tells it from others of its kind, JSON-able."""

    @staticmethod
    @abstractmethod
    def is_asked(asked: Any) -> bool:
        """Whether what was read from a file is what a question of this kind asks."""

    @abstractmethod
    def lay_out(self, folder: Path) -> Sequence[str]:
        """Lay what is asked about into an empty folder where it does not lie together; the command's arguments.

        Raises:
            OSError: It cannot be laid there.
        """


@dataclass(frozen=True, eq=False)
class DiagnosisAnswer:
    """What the diagnosis answered.

    Attributes:
        asked: As `DiagnosisQuestion.asked`.
        document: Content of diagnosis.json; None where there is none.
        model: Content of model.yaml, empty where the kind of question leaves none.
        failure: Why there is no document, empty when there is.
    """

    asked: dict[str, Any]
    document: dict[str, Any] | None = None
    model: bytes = b""
    failure: str = ""
