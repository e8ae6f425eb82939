"""The controller behind the web services: what they read of it and change, nothing kept twice."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import StopCause, StopMode
from doormill_ros.simulation.controller.rapid.errors import RapidProgramError


@dataclass(frozen=True)
class LogItem:
    """An entry of the event log.

    Attributes:
        number: Its place, counted from 1.
        time: When, seconds since 1970.
        kind: "information", "warning" or "error".
        code: Number of the event, 80001 and on for those of the program.
        title: Its title.
        text: The rest.
    """

    number: int
    time: float
    kind: str
    code: int
    title: str
    text: str


@dataclass(frozen=True)
class SymbolItem:
    """A persistent of the program: name as declared, its module and the name of its type."""

    module: str
    name: str
    type: str


class ServedController(Protocol):
    """State, program, arm, signals and event log; safe to use from the web server's thread.

    Joint angles are in degrees and positions in millimetres, as RAPID has them.
    """

    @property
    def panel(self) -> ControlPanel:
        """Operating mode, drives, execution, override, and the orders that change them."""
        ...

    def start(self) -> None:
        """Go on with the program.

        Raises:
            OrderRefusedError: Not in this state.
        """
        ...

    def stop(self, mode: StopMode) -> None:
        """Stop the program."""
        ...

    def reset_pointer(self) -> None:
        """Program pointer to main.

        Raises:
            OrderRefusedError: The program runs.
        """
        ...

    def joints(self) -> list[float]:
        """Angles of the six axes [deg]."""
        ...

    def target(self, tool: str, wobj: str) -> list[list[float]]:
        """Where the robot stands as a robtarget, by the names of tool and work object."""
        ...

    def symbols(self) -> list[SymbolItem]:
        """All persistents."""
        ...

    def read_symbol(self, module: str, name: str) -> str:
        """A persistent's value as a literal.

        Raises:
            RapidProgramError: There is none.
        """
        ...

    def write_symbol(self, module: str, name: str, literal: str) -> None:
        """Set a persistent.

        Raises:
            RapidProgramError: There is none, or the literal is not of its type.
        """
        ...

    def modules(self) -> list[str]:
        """Modules of the task."""
        ...

    def read_signal(self, name: str) -> float:
        """A configured signal."""
        ...

    def write_signal(self, name: str, value: float) -> None:
        """Set a configured output."""
        ...

    def event_log(self) -> list[LogItem]:
        """All entries, oldest first."""
        ...


class IdleController:
    """A controller whose program nobody runs: it holds what it is told, for clients without a robot.

    Attributes:
        data: Persistents by "module/name", as literals.
        levels: Signals that were written.
        log: The event log.
    """

    def __init__(self) -> None:
        """Say that the program runs."""
        self.data: dict[str, str] = {}
        self.levels: dict[str, float] = {}
        self.log: list[LogItem] = []
        self.panel = ControlPanel(self._log)
        self.panel.started()

    def start(self) -> None:
        """Say that it runs."""
        self.panel.start()
        self.panel.started()

    def stop(self, mode: StopMode) -> None:
        """Say that it stands."""
        self.panel.stop(mode)
        self.panel.stopped(StopCause.PROGRAM_STOP, "ordered")

    def reset_pointer(self) -> None:
        """Say that the pointer is at main."""
        self.panel.pointer_to_main()
        self.panel.pointer_at_main()

    def _log(self, kind: str, title: str, text: str, number: int = 0) -> None:
        self.log.append(LogItem(len(self.log) + 1, time.time(), kind, number, title, text))

    def joints(self) -> list[float]:
        """All axes at 0."""
        return [0.0] * 6

    def target(self, tool: str, wobj: str) -> list[list[float]]:
        """A target at the origin."""
        del tool, wobj
        return [[0.0] * 3, [1.0, 0.0, 0.0, 0.0], [0.0] * 4, [9e9] * 6]

    def symbols(self) -> list[SymbolItem]:
        """The data."""
        places = [path.split("/") for path in self.data]
        return [SymbolItem(module, name, "anytype") for module, name in places]

    def read_symbol(self, module: str, name: str) -> str:
        """The data's literal."""
        if f"{module}/{name}" not in self.data:
            raise RapidProgramError(f"no persistent {name!r} in module {module!r}: correct the name")
        return self.data[f"{module}/{name}"]

    def write_symbol(self, module: str, name: str, literal: str) -> None:
        """Keep the literal."""
        self.read_symbol(module, name)
        self.data[f"{module}/{name}"] = literal

    def modules(self) -> list[str]:
        """Modules that data belong to."""
        return sorted({path.split("/")[0] for path in self.data})

    def read_signal(self, name: str) -> float:
        """What was written, else 0."""
        return self.levels.get(name, 0.0)

    def write_signal(self, name: str, value: float) -> None:
        """Keep the value."""
        self.levels[name] = value

    def event_log(self) -> list[LogItem]:
        """The log."""
        return list(self.log)


def literal_of(value: object) -> str:
    """A RAPID value as Robot Web Services write it.

    Args:
        value: Number, text, truth value, or a list of them.
    """
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '""') + '"'
    if isinstance(value, list):
        return "[" + ",".join(literal_of(item) for item in value) + "]"
    number = float(str(value))
    return f"{number:.9G}".replace("E+0", "E+").replace("E+", "E+0" if abs(number) < 1e10 else "E+")


def level_text(value: float) -> str:
    """A signal's value: whole numbers without a point."""
    return str(int(value)) if value == int(value) else f"{value:.6g}"


def as_mapping(item: SymbolItem) -> Mapping[str, str]:
    """A persistent as the search for symbols lists it."""
    return {
        "symburl": f"RAPID/T_ROB1/{item.module}/{item.name}",
        "name": item.name,
        "symtyp": "per",
        "dattyp": item.type,
        "local": "FALSE",
    }
