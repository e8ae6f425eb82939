"""Whom a run has to do with, as far as it knows them: the controller's handshake and link, and the recipe database."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence, Set, Sized
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from doormill_ros.abb.handshake.state import HandshakeSnapshot, RunOutcome
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.run.run import StageAnswer


class ControllerHandshake(Protocol):
    """What the course sees of the handshake with the controller."""

    @property
    def snapshot(self) -> HandshakeSnapshot:
        """Its state at this instant."""

    def outcome(self, run_id: str) -> RunOutcome | None:
        """How a submitted run ended, None while it goes on or when it is unknown."""


class Targets(StageAnswer, Protocol):
    """The answer of the path generator; `largest_correction` in m, `model_version` 0 for the model of the start."""

    targets: Sized
    largest_correction: float
    robot_model: str
    model_version: int


class Handover(Protocol):
    """The link to the controller."""

    @property
    def handshake(self) -> ControllerHandshake:
        """The handshake; whoever owns it lets the run look again after each of its changes."""

    def submit(self, targets: Any, request_number: int) -> bytes:
        """Render the target file of a `Targets` and hand it over for that request; returns its bytes.

        Raises:
            AbbError: The targets cannot be written, or the handshake does not take them.
        """

    def file_away(self, run_id: str, data: bytes) -> Path:
        """Keep a copy of a submitted target file.

        Raises:
            OSError: There is no folder to keep it in.
            TargetFileWriteError: It cannot be written.
        """


class Attendance(Protocol):
    """Which nodes of the cell are alive; lets the run look again after each change."""

    @property
    def settled(self) -> bool:
        """No two nodes of one name are alive, not even for the moment of a restart."""

    def require(self, names: Sequence[str]) -> None:
        """Let a run go on that needs these nodes.

        Raises:
            NodeDeadError: One of them has died.
            NodeDoubledError: Of one of them there are two: another cell's would be taken for this one's.
        """


@dataclass(frozen=True)
class RecipeAnswer:
    """What the recipe database answers: the recipe's version, or why there is none."""

    accepted: bool
    error_code: int
    reason: str
    version: int


class Inspector(Protocol):
    """Who measures milled doors, if anybody does; lets the run look again whenever a door was measured."""

    @property
    def present(self) -> Set[Hashable]:
        """Who they are; one that was started again is another."""

    def found(self, run_id: str) -> MeasuredDoor | None:
        """How a run's door came out, None while nobody has told."""


class Recipes(Protocol):
    """The recipe database, which tells the stages of the recipe it is asked for under a run's id."""

    @property
    def ready(self) -> bool:
        """It can be asked."""

    def ask(self, door_id: str, run_id: str, hear: Callable[[RecipeAnswer], None]) -> None:
        """Ask for a door's recipe; `hear` is called with the answer, from any thread or never."""
