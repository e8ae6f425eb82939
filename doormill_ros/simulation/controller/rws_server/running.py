"""The virtual controller as the web services see it."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from doormill_ros.simulation.controller.cabinet.io_port import IoPort
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import StopMode
from doormill_ros.simulation.controller.rapid.errors import RapidProgramError
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.scope import GlobalSymbol
from doormill_ros.simulation.controller.rapid.types import Value
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet, SimulatedSignal
from doormill_ros.simulation.controller.rws_server.served import LogItem, SymbolItem, literal_of


class RunningController:
    """Shows the controller that runs at the moment; one controller may follow another, as after a restart."""

    def __init__(self, current: Callable[[], VirtualController]) -> None:
        """Begin its clock.

        Args:
            current: Gives the controller that runs now.
        """
        self._current = current
        self._begun = time.time()

    @property
    def panel(self) -> ControlPanel:
        """States and orders."""
        return self._current().panel

    def start(self) -> None:
        """Go on with the program."""
        self.panel.start()

    def stop(self, mode: StopMode) -> None:
        """Stop the program."""
        self.panel.stop(mode)

    def reset_pointer(self) -> None:
        """Program pointer to main."""
        self.panel.pointer_to_main()

    def joints(self) -> list[float]:
        """Angles of the six axes [deg]."""
        return self._current().current_joints()

    def target(self, tool: str, wobj: str) -> list[list[float]]:
        """Where the robot stands, as a robtarget."""
        controller = self._current()
        found: list[list[float]] = controller.current_target(
            controller.program.read(tool), controller.program.read(wobj)
        )
        return found

    def symbols(self) -> list[SymbolItem]:
        """All persistents."""
        return [
            SymbolItem(module, symbol.name, symbol.type.name)
            for module, symbol in self._current().program.persistents()
        ]

    def read_symbol(self, module: str, name: str) -> str:
        """A persistent's value as a literal."""
        return literal_of(self._symbol(module, name).store[0])

    def write_symbol(self, module: str, name: str, literal: str) -> None:
        """Set a persistent."""
        symbol = self._symbol(module, name)
        value: Value | None = parse_literal(literal, symbol.type)
        if value is None:
            raise RapidProgramError(
                f"PERS {name} cannot become {literal}, allowed is a literal of type {symbol.type.name}: "
                "correct the value",
                name=name,
            )
        symbol.store[0] = value

    def modules(self) -> list[str]:
        """Modules of the task."""
        return list(self._current().program.module_names)

    def read_signal(self, name: str) -> float:
        """A configured signal."""
        return self._current().cell.read(name)

    def write_signal(self, name: str, value: float) -> None:
        """Set a configured output."""
        self._current().cell.force(name, value)

    def event_log(self) -> list[LogItem]:
        """All entries, oldest first."""
        return [
            LogItem(number, self._begun + entry.time, entry.kind, entry.number, entry.title, entry.text)
            for number, entry in enumerate(self._current().event_log, 1)
        ]

    def _symbol(self, module: str, name: str) -> GlobalSymbol:
        for of, symbol in self._current().program.persistents():
            if (of.lower(), symbol.name.lower()) == (module.lower(), name.lower()):
                return symbol
        raise RapidProgramError(f"no persistent {name!r} in module {module!r}: correct the name", name=name)


def served_cabinet(home: Path, io: IoPort, current: Callable[[], VirtualController]) -> Cabinet:
    """What web services over a virtual controller give access to.

    Args:
        home: Its HOME folder.
        io: Its port of the handshake's signals.
        current: Gives the controller that runs now.
    """
    return Cabinet.create(home, configured_signals(current()), io, RunningController(current))


def configured_signals(controller: VirtualController) -> tuple[SimulatedSignal, ...]:
    """Every configured signal of a controller."""
    return tuple(
        SimulatedSignal(signal.name, signal.access, kind=signal.type, largest=signal.largest)
        for signal in controller.cell.configuration.signals.values()
    )
