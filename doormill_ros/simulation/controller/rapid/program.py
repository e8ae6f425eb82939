"""Load RAPID modules into one task and run them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.errors import (
    RapidProgramError,
    RapidRuntimeError,
    RapidStoppedError,
)
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop, error_name
from doormill_ros.simulation.controller.rapid.library import files, motion, numbers, pendant, signals, strings  # noqa: F401
from doormill_ros.simulation.controller.rapid.library.registry import install
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.machine import Machine
from doormill_ros.simulation.controller.rapid.predefined_data import install_data
from doormill_ros.simulation.controller.rapid.scope import (
    Context,
    Frame,
    Names,
    RoutineInfo,
    Symbol,
    describe_parameters,
    program_error,
    resolve_type,
)
from doormill_ros.simulation.controller.rapid.statements import StatementCompiler
from doormill_ros.simulation.controller.rapid.types import (
    NUM,
    PREDEFINED,
    AnyType,
    ArrayType,
    Type,
    Value,
    copy,
    default,
    is_integer,
)

#: Nested calls; deeper programs are mistakes, and Python's own stack ends not far behind.
MAX_DEPTH = 40
MAX_ARRAY = 2_000_000


class Program:
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
        self._types = Names()
        for name, kind in PREDEFINED.items():
            self._types.add(name, kind)
        outer_data, outer_routines = Names(), Names()
        install(self.context, self._types, outer_routines)
        install_data(self.context, outer_data)
        self._data = Names(outer_data)
        self._routines = Names(outer_routines)
        self._scopes = {id(m): (Names(self._data), Names(self._routines)) for m in modules}
        self._initial: list[tuple[Symbol, Value]] = []
        self._persistent: dict[str, Symbol] = {}
        for module in modules:
            self._declare_types(module)
        self._declare_data(modules)
        compiled = [self._declare_routines(module) for module in modules]
        for module, infos in zip(modules, compiled, strict=True):
            for routine, info in infos:
                self._compile(module, routine, info)

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
        return {name: copy(symbol.store[0]) for name, symbol in self._persistent.items()}

    def restore(self, data: Mapping[str, Value]) -> None:
        """Give PERS the values that `persistent_data` gave of the same modules."""
        for name, value in data.items():
            self._persistent[name].store[0] = copy(value)

    def has_data(self, name: str) -> bool:
        """Whether global data of that name is loaded."""
        return self._data.has_here(name)

    def has_routine(self, name: str) -> bool:
        """Whether a procedure or function of that name is loaded."""
        return self._routines.has_here(name)

    def _global(self, name: str) -> Symbol:
        found = self._data.find(name)
        if not isinstance(found, Symbol) or found.store is None:
            raise RapidProgramError(f"no global data {name!r} is loaded: correct the name", name=name)
        return found

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
        info = self._routines.find(routine)
        if not isinstance(info, RoutineInfo) or info.type is not None or info.parameters:
            raise RapidProgramError(f"no procedure {routine!r} without parameters is loaded")
        context = self.context
        context.depth = 0
        if reset:
            for symbol, value in self._initial:
                symbol.store[0] = copy(value)
        try:
            info.run([])
        except RapidFault as fault:
            reason = f"{error_name(fault.number)}: {fault.reason}"
            raise self._report(fault.file, fault.line, reason) from None
        except RapidStop as stop:
            if not stop.by_program:
                raise self._report(stop.file, stop.line, stop.reason) from None
        except RapidStoppedError as stop:
            context.machine.log("error", "program stopped", stop.message)
            raise
        except RecursionError:
            raise self._report(context.file, context.line, "nested too deeply") from None
        finally:
            for device in context.devices:
                device.stream.close()
            context.devices.clear()

    def _report(self, file: str, line: int, reason: str) -> RapidRuntimeError:
        self.context.machine.log("error", "program stopped", f"{file}, line {line}: {reason}")
        text = f"{file}, line {line}: {reason}; no ERROR clause took it: see the event log"
        return RapidRuntimeError(text, file=file, line=line, reason=reason)

    # Loading

    def _declare_types(self, module: s.Module) -> None:
        for node in module.types:
            if self._types.has_here(node.name):
                raise program_error(
                    module.file, node.line, f"type {node.name!r} is declared twice: rename one"
                )
            if isinstance(node, s.Alias):
                kind = resolve_type(self._types, node.type_name, module.file, node.line)
            else:
                parts = tuple(
                    (name.lower(), resolve_type(self._types, type_name, module.file, node.line))
                    for type_name, name in node.components
                )
                kind = Type(node.name, "record", parts)
            self._types.add(node.name, kind)

    def _declare_data(self, modules: Sequence[s.Module]) -> None:
        """Declare module data in whatever order their initial values allow."""
        waiting = [(module, node) for module in modules for node in module.data]
        while waiting:
            later, first_error = [], None
            for module, node in waiting:
                try:
                    self._declare(module, node)
                except RapidProgramError as error:
                    first_error = first_error or error
                    later.append((module, node))
            if len(later) == len(waiting):
                raise first_error
            waiting = later

    def _declare(self, module: s.Module, node: s.Data) -> None:
        names, routines = self._scopes[id(module)]
        compiler = StatementCompiler(module.file, self.context, names, routines, self._types)
        kind = self._data_type(module, compiler, node)
        scope = names if node.local else self._data
        if scope.has_here(node.name):
            raise program_error(module.file, node.line, f"{node.name!r} is declared twice: rename one")
        if node.storage != "VAR" and node.initial is None:
            raise program_error(
                module.file, node.line, f"{node.storage} {node.name} has no initial value: give it one"
            )
        value = self._initial_value(module, compiler, node, kind)
        symbol = Symbol(node.name, kind, node.storage, store=[value])
        scope.add(node.name, symbol)
        if node.storage == "VAR":
            self._initial.append((symbol, copy(value)))
        elif node.storage == "PERS":
            self._persistent[f"{module.name}.{node.name}".lower()] = symbol

    def _data_type(self, module: s.Module, compiler: StatementCompiler, node: s.Data) -> AnyType:
        element = resolve_type(self._types, node.type_name, module.file, node.line)
        if element.kind in ("switch", "any", "condition", "signal"):
            raise program_error(module.file, node.line, f"data of type {element.name} cannot be declared")
        lengths, size = [], 1
        for dimension in node.dimensions:
            length = compiler.typed(dimension, NUM, "the length")([])
            size = size * int(length) if is_integer(length) and 1 <= length <= MAX_ARRAY else MAX_ARRAY + 1
            if size > MAX_ARRAY or len(node.dimensions) > 3:
                raise program_error(
                    module.file,
                    node.line,
                    f"{node.name} has a dimension of {length:g}, allowed are 1 to 3 dimensions and at most "
                    f"{MAX_ARRAY} elements",
                )
            lengths.append(int(length))
        return ArrayType(element, tuple(lengths)) if lengths else element

    def _initial_value(
        self, module: s.Module, compiler: StatementCompiler, node: s.Data, kind: AnyType
    ) -> Value:
        if node.initial is None:
            return default(kind)
        run = compiler.typed(node.initial, kind, f"the initial value of {node.name}")
        try:
            return copy(run([]))
        except (RapidFault, RapidStop) as fault:
            raise program_error(
                module.file, node.line, f"the initial value of {node.name} cannot be computed: {fault}"
            ) from None

    def _declare_routines(self, module: s.Module) -> list[tuple[s.Routine, RoutineInfo]]:
        names, local_routines = self._scopes[id(module)]
        infos = []
        for node in module.routines:
            scope = local_routines if node.local else self._routines
            data_scope = names if node.local else self._data
            if scope.has_here(node.name) or data_scope.has_here(node.name):
                raise program_error(module.file, node.line, f"{node.name!r} is declared twice: rename one")
            kind = (
                resolve_type(self._types, node.type_name, module.file, node.line) if node.type_name else None
            )
            parameters = describe_parameters(node, self._types, module.file)
            info = RoutineInfo(node.name, kind, parameters, run=lambda frame: None)
            scope.add(node.name, info)
            infos.append((node, info))
        return infos

    def _compile(self, module: s.Module, node: s.Routine, info: RoutineInfo) -> None:
        outer, routines = self._scopes[id(module)]
        names = Names(outer)
        compiler = StatementCompiler(module.file, self.context, names, routines, self._types)
        compiler.result = info.type
        for slot, parameter in enumerate(info.parameters):
            by_reference = parameter.mode != "IN"
            symbol = Symbol(
                parameter.name,
                parameter.type,
                parameter.mode,
                slot=slot,
                by_reference=by_reference,
                optional=parameter.optional,
            )
            self._add_local(module, node, names, symbol)
        setups = []
        compiler.slots = len(info.parameters)
        for data in node.data:
            setups.append(self._local_data(module, node, compiler, names, data))
        body = compiler.compile_body(node.body, node.handler)
        info.run = self._caller(module.file, node, info, setups, body, compiler.slots)

    def _add_local(self, module: s.Module, node: s.Routine, names: Names, symbol: Symbol) -> None:
        if names.has_here(symbol.name):
            raise program_error(module.file, node.line, f"{symbol.name!r} is declared twice in {node.name}")
        names.add(symbol.name, symbol)

    def _local_data(self, module, node, compiler, names, data):
        if data.storage == "PERS":
            raise program_error(module.file, data.line, f"PERS {data.name} stands in a routine: move it out")
        kind = self._data_type(module, compiler, data)
        what = f"the initial value of {data.name}"
        run = None if data.initial is None else compiler.typed(data.initial, kind, what)
        slot = compiler.slots
        compiler.slots += 1
        self._add_local(module, node, names, Symbol(data.name, kind, data.storage, slot=slot))

        def setup(frame: Frame) -> None:
            frame[slot] = default(kind) if run is None else copy(run(frame))

        return setup

    def _caller(self, file, node, info, setups, body, slots):
        """Code that runs the routine on its argument slots."""
        context = self.context
        extra = slots - len(info.parameters)
        is_function = info.type is not None

        def call(arguments: Frame) -> Value:
            if context.depth >= MAX_DEPTH:
                raise RapidStop(f"{node.name}: more than {MAX_DEPTH} nested calls")
            saved = context.file, context.line
            context.depth += 1
            context.file, context.line = file, node.line
            try:
                frame = [*arguments, *[None] * extra]
                for setup in setups:
                    setup(frame)
                outcome = body(frame)
                if not is_function:
                    return None
                if outcome is None or outcome[1] is None:
                    raise RapidStop(f"function {node.name} ended without RETURN")
                return outcome[1]
            except (RapidFault, RapidStop) as problem:
                if not problem.file:
                    problem.file, problem.line = context.file, context.line
                raise
            finally:
                context.depth -= 1
                context.file, context.line = saved

        return call
