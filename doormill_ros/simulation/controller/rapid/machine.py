"""The seam between the RAPID interpreter and the controller around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from doormill_ros.simulation.controller.rapid.types import Value


@dataclass(frozen=True)
class Move:
    r"""A motion instruction as the program gives it, in RAPID's values and units.

    Attributes:
        kind: "MoveJ", "MoveL", "MoveC" or "MoveAbsJ".
        target: robtarget, or jointtarget for MoveAbsJ.
        via: Circle point of MoveC, else None.
        speed: speeddata.
        zone: zonedata.
        tool: tooldata.
        wobj: wobjdata.
        duration: `\T` in seconds, None without it.
        file: Module file of the instruction.
        line: Its line.
    """

    kind: str
    target: Value
    via: Value | None
    speed: Value
    zone: Value
    tool: Value
    wobj: Value
    duration: float | None
    file: str
    line: int


@dataclass(frozen=True)
class NumberField:
    """Where the operator types a number.

    Attributes:
        initial: What stands in it at the beginning.
        least: The smallest number that can be confirmed, None for any.
        largest: The largest one.
        integer: Whether whole numbers alone can be confirmed.
    """

    initial: float = 0.0
    least: float | None = None
    largest: float | None = None
    integer: bool = False

    def takes(self, number: float) -> bool:
        """Whether a number can be confirmed."""
        within = (self.least is None or number >= self.least) and (
            self.largest is None or number <= self.largest
        )
        return within and (not self.integer or number.is_integer())


@dataclass(frozen=True)
class Dialog:
    """A question on the pendant.

    Attributes:
        kind: "UIMsgBox", "UIMessageBox", "UIListView", "UINumEntry" or "TPReadFK".
        header: Its title.
        lines: Its text.
        buttons: What can be pressed: the text, and the number that stands for it.
        items: Of a list, the texts to choose from.
        chosen: Number of the item that is marked at the beginning, 0 for none.
        field: Where a number is typed, None in a question for none.
    """

    kind: str
    header: str
    lines: tuple[str, ...]
    buttons: tuple[tuple[str, float], ...]
    items: tuple[str, ...] = ()
    chosen: int = 0
    field: NumberField | None = None


@dataclass(frozen=True)
class DialogAnswer:
    """What the operator chose: the number of a button, and of a list's item, 0 for none; the number he typed."""

    button: float
    item: int = 0
    typed: float = 0.0


class Attendant(Protocol):
    """What wants to look after the signals as time passes: the interrupts of a program."""

    @property
    def armed(self) -> bool:
        """Whether there is anything to look for."""
        ...

    def attend(self) -> None:
        """Look, and run what is due; may let time pass and move the robot in turn."""
        ...


class Machine(Protocol):
    """What a RAPID program can reach outside itself."""

    def set_attendant(self, attendant: Attendant) -> None:
        """Take what is called at least every 10 ms of simulated time, in all that waits or moves."""
        ...

    @property
    def home(self) -> Path:
        """Folder behind HOME:."""
        ...

    def signal_kinds(self) -> dict[str, str]:
        """Configured signals: name to "signaldi", "signaldo", "signalai", "signalao", "signalgi" or "signalgo"."""
        ...

    def read_signal(self, name: str) -> float:
        """Present value of a signal."""
        ...

    def write_signal(self, name: str, value: float) -> None:
        """Set an output."""
        ...

    def now(self) -> float:
        """Simulated time [s]."""
        ...

    def statement(self, file: str, line: int) -> None:
        """Called before each statement; raises RapidStop to end the program."""
        ...

    def wait(self, condition: Callable[[], bool] | None, seconds: float | None) -> bool:
        """Let time pass until the condition holds (True) or the seconds are over (False)."""
        ...

    def stop_program(self, instruction: str) -> None:
        """Stop as the instruction orders; returns when the operator has started the program again."""
        ...

    def move(self, move: Move) -> None:
        """Take a motion; returns when the program pointer may go on."""
        ...

    def wait_in_position(self) -> None:
        """Let time pass until the robot stands still at its last target."""
        ...

    def wait_at_rest(self) -> None:
        """Let time pass until the robot stands still, on its path or at the end of it."""
        ...

    def stop_motion(self, clear: bool) -> None:
        """Stop the robot on its path; `clear` forgets the motions that are left."""
        ...

    def restart_motion(self) -> None:
        """Go on with stopped motions."""
        ...

    def store_path(self) -> None:
        """Put the motions that are left aside; the robot can then be moved on another path."""
        ...

    def restore_path(self) -> None:
        """Take the motions up again that were put aside; they stay stopped until `restart_motion`."""
        ...

    def supervise_configuration(self, linear: bool, on: bool) -> None:
        """ConfL or ConfJ, on or off."""
        ...

    def forget_paths(self) -> None:
        """Stop the robot and forget all motions that are left, those put aside too; new ones may come."""
        ...

    def current_joints(self) -> list[float]:
        """Joint angles where the robot stands [deg]."""
        ...

    def current_target(self, tool: Value, wobj: Value) -> Value:
        """Robtarget where the robot stands."""
        ...

    def pendant(self, text: str) -> None:
        """Show a line on the pendant."""
        ...

    def show_dialog(self, dialog: Dialog | None) -> None:
        """Show a question on the pendant; None takes it away."""
        ...

    def dialog_answer(self) -> DialogAnswer | None:
        """What the operator chose since the question was shown, None while he has not."""
        ...

    def operating_mode(self) -> str:
        """Operating mode: "AUTO", "MANR" (manual, reduced speed) or "MANF" (manual, full speed)."""
        ...

    def joints_of(self, target: Value, tool: Value, wobj: Value) -> list[float] | None:
        """Joint angles of a robtarget in its configuration [deg], None when it cannot be reached."""
        ...

    def target_of(self, joints: Value, tool: Value, wobj: Value) -> Value:
        """Robtarget of joint angles [deg]."""
        ...

    def log(self, kind: str, title: str, text: str, number: int = 0) -> None:
        """Add to the event log; kind is "information", "warning" or "error"."""
        ...
