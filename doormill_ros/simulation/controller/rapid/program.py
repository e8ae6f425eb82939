"""A task of RAPID modules: its data as a panel sees it, and running its routines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.errors import (
    RapidProgramError,
    RapidRuntimeError,
    RapidStoppedError,
)
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop, error_name
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.loader import LoadedModules
from doormill_ros.simulation.controller.rapid.machine import Machine
from doormill_ros.simulation.controller.rapid.scope import GlobalSymbol, RoutineInfo
from doormill_ros.simulation.controller.rapid.types import Value, copy

#: Event of a program that stopped with an error [?].
EXECUTION_ERROR = 10020


class RapidProgram:
    """The modules of one task, loaded and ready to run.

    Global data lives as long as this object: PERS keep their values from run to run, VAR are set
    to their initial values whenever the program pointer goes to main.
    """

    def __init__(self, modules: Sequence[s.Module], machine: Machine) -> None:
        """Load modules as one task.

        Raises:
            RapidProgramError: What a controller would refuse to load; names file and line.
            RapidUnsupportedError: A routine or argument outside the executed subset.
        """
        self.context = Context(machine)
        self._parsed = tuple(modules)
        #: The last run ended with EXIT.
        self.pointer_lost = False
        self._modules = LoadedModules(modules, self.context)
        self.module_names = tuple(module.name for module in modules)

    # Data from outside, as a panel or Robot Web Services see it

    def read(self, name: str) -> Value:
        """A copy of global data.

        Raises:
            RapidProgramError: No such data.
        """
        return copy(self._global(name).store[0])

    def write(self, name: str, literal: str) -> None:
        """Set PERS or VAR from a literal, `"text"`, `3.5`, `[1,2]`.

        Raises:
            RapidProgramError: No such data, or the literal is not of its type.
        """
        symbol = self._global(name)
        value = parse_literal(literal, symbol.type)
        if value is None or symbol.storage not in ("PERS", "VAR"):
            raise RapidProgramError(
                f"{symbol.storage} {name} of type {symbol.type.name} cannot become {literal}, allowed is a "
                "literal of that type for PERS or VAR: correct the value",
                name=name,
                literal=literal,
            )
        symbol.store[0] = value

    def persistent_data(self) -> dict[str, Value]:
        """All PERS by "module.name", as a controller keeps them when it is switched off."""
        return {name: copy(symbol.store[0]) for name, symbol in self._modules.persistent.items()}

    def persistents(self) -> list[tuple[str, GlobalSymbol]]:
        """All PERS with the module that declares them: the data themselves, not copies."""
        named = {name.lower(): name for name in self.module_names}
        return [(named[key.split(".")[0]], symbol) for key, symbol in self._modules.persistent.items()]

    def restore(self, data: Mapping[str, Value]) -> None:
        """Give PERS the values that `persistent_data` gave of the same modules."""
        for name, value in data.items():
            self._modules.persistent[name].store[0] = copy(value)

    def reload(self) -> None:
        """Load the modules anew: every VAR and PERS has the value of the module text again.

        That is what loading a module, restoring a backup without its data or a start without the old
        program does to PERS; a warm start keeps them [?].
        """
        self.context.interrupts.clear()
        self._modules = LoadedModules(self._parsed, self.context)

    def has_data(self, name: str) -> bool:
        """Whether global data of that name is loaded."""
        return self._modules.data.has_here(name)

    def _global(self, name: str) -> GlobalSymbol:
        found = self._modules.data.find(name)
        if not isinstance(found, GlobalSymbol):
            raise RapidProgramError(f"no global data {name!r} is loaded: correct the name", name=name)
        return found

    def has_procedure(self, name: str) -> bool:
        """Whether a procedure without parameters of that name is loaded."""
        return self._procedure(name) is not None

    def _procedure(self, name: str) -> RoutineInfo | None:
        info = self._modules.routines.find(name)
        if not isinstance(info, RoutineInfo) or info.predefined or info.trap:
            return None
        return info if info.type is None and not info.parameters else None

    # Running

    def run(self, routine: str = "main", reset: bool = True) -> None:
        """Run a procedure without parameters to its end.

        Args:
            routine: Its name.
            reset: Set VAR to their initial values first, as moving the program pointer does.

        Raises:
            RapidRuntimeError: An error that no ERROR clause took; names file, line and ERRNO.
            RapidStoppedError: Stopped from outside.
            AbbError: What the machine raises, such as RapidMotionError.
        """
        info = self._procedure(routine)
        if info is None:
            raise RapidProgramError(f"no procedure {routine!r} without parameters is loaded")
        context = self.context
        context.depth = 0
        self.pointer_lost = False
        if reset:
            for symbol, value in self._modules.initial:
                symbol.store[0] = copy(value)
            context.interrupts.clear()
        try:
            info.run([])
        except RapidFault as fault:
            reason = f"{error_name(fault.number)}: {fault.reason}"
            raise self._report(fault.file, fault.line, reason) from None
        except RapidStop as stop:
            self.pointer_lost = stop.pointer_lost
            if not stop.by_program:
                raise self._report(stop.file, stop.line, stop.reason) from None
        except RapidStoppedError as stop:
            context.machine.log("error", "program stopped", stop.message, EXECUTION_ERROR)
            raise
        except RecursionError:
            raise self._report(context.file, context.line, "nested too deeply") from None
        finally:
            for device in context.devices:
                device.stream.close()
            context.devices.clear()

    def _report(self, file: str, line: int, reason: str) -> RapidRuntimeError:
        self.context.machine.log(
            "error", "program stopped", f"{file}, line {line}: {reason}", EXECUTION_ERROR
        )
        text = f"{file}, line {line}: {reason}; no ERROR clause took it: see the event log"
        return RapidRuntimeError(text, file=file, line=line, reason=reason)
