"""Load RAPID modules as one task: declare types, data and routines, then compile the routines."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.errors import RapidProgramError
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.handlers import Step
from doormill_ros.simulation.controller.rapid.library.registry import install
from doormill_ros.simulation.controller.rapid.predefined_data import install_data
from doormill_ros.simulation.controller.rapid.scope import (
    Frame,
    GlobalSymbol,
    LocalSymbol,
    Names,
    RoutineInfo,
    Run,
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


class LoadedModules:
    """The modules of one task with every name resolved and every routine compiled.

    Attributes:
        data: Global data by name.
        routines: Global routines by name.
        initial: All VAR and their initial values.
        persistent: All PERS by "module.name" in lower case.
    """

    def __init__(self, modules: Sequence[s.Module], context: Context) -> None:
        """Load the modules; the compiled routines run on `context`.

        Raises:
            RapidProgramError: What a controller would refuse to load; names file and line.
            RapidUnsupportedError: A routine or argument outside the executed subset.
        """
        self._context = context
        self._types = Names()
        for name, kind in PREDEFINED.items():
            self._types.add(name, kind)
        outer_data, outer_routines = Names(), Names()
        install(context, self._types, outer_routines)
        install_data(context, outer_data)
        self.data = Names(outer_data)
        self.routines = Names(outer_routines)
        self.initial: list[tuple[GlobalSymbol, Value]] = []
        self.persistent: dict[str, GlobalSymbol] = {}
        self._scopes = {id(m): (Names(self.data), Names(self.routines)) for m in modules}
        for module in modules:
            self._declare_types(module)
        self._declare_data(modules)
        compiled = [self._declare_routines(module) for module in modules]
        for module, infos in zip(modules, compiled, strict=True):
            for routine, info in infos:
                self._compile(module, routine, info)

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
            later, errors = [], []
            for module, node in waiting:
                try:
                    self._declare(module, node)
                except RapidProgramError as error:
                    errors.append(error)
                    later.append((module, node))
            if len(later) == len(waiting):
                raise errors[0]
            waiting = later

    def _declare(self, module: s.Module, node: s.Data) -> None:
        names, routines = self._scopes[id(module)]
        compiler = StatementCompiler(module.file, self._context, names, routines, self._types)
        kind = self._data_type(module, compiler, node)
        scope = names if node.local else self.data
        if scope.has_here(node.name):
            raise program_error(module.file, node.line, f"{node.name!r} is declared twice: rename one")
        if node.storage != "VAR" and node.initial is None:
            raise program_error(
                module.file, node.line, f"{node.storage} {node.name} has no initial value: give it one"
            )
        value = self._initial_value(module, compiler, node, kind)
        symbol = GlobalSymbol(node.name, kind, node.storage, [value])
        scope.add(node.name, symbol)
        if node.storage == "VAR":
            self.initial.append((symbol, copy(value)))
        elif node.storage == "PERS":
            self.persistent[f"{module.name}.{node.name}".lower()] = symbol

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
            scope = local_routines if node.local else self.routines
            data_scope = names if node.local else self.data
            if scope.has_here(node.name) or data_scope.has_here(node.name):
                raise program_error(module.file, node.line, f"{node.name!r} is declared twice: rename one")
            kind = (
                resolve_type(self._types, node.type_name, module.file, node.line) if node.type_name else None
            )
            parameters = describe_parameters(node, self._types, module.file)
            info = RoutineInfo(node.name, kind, parameters, run=lambda frame: None, trap=node.trap)
            scope.add(node.name, info)
            infos.append((node, info))
        return infos

    def _compile(self, module: s.Module, node: s.Routine, info: RoutineInfo) -> None:
        outer, routines = self._scopes[id(module)]
        names = Names(outer)
        compiler = StatementCompiler(
            module.file,
            self._context,
            names,
            routines,
            self._types,
            info.type,
            len(info.parameters),
            info.trap,
        )
        for slot, parameter in enumerate(info.parameters):
            symbol = LocalSymbol(
                parameter.name,
                parameter.type,
                parameter.mode,
                slot,
                by_reference=parameter.mode != "IN",
                optional=parameter.optional,
            )
            self._add_local(module, node, names, symbol)
        setups = [self._local_data(module, node, compiler, names, data) for data in node.data]
        body = compiler.compile_body(node.body, node.handler)
        info.run = self._caller(module.file, node, info, setups, body, compiler.slots)

    def _add_local(self, module: s.Module, node: s.Routine, names: Names, symbol: Symbol) -> None:
        if names.has_here(symbol.name):
            raise program_error(module.file, node.line, f"{symbol.name!r} is declared twice in {node.name}")
        names.add(symbol.name, symbol)

    def _local_data(
        self, module: s.Module, node: s.Routine, compiler: StatementCompiler, names: Names, data: s.Data
    ) -> Run:
        """Code that gives local data its initial value."""
        if data.storage == "PERS":
            raise program_error(module.file, data.line, f"PERS {data.name} stands in a routine: move it out")
        kind = self._data_type(module, compiler, data)
        what = f"the initial value of {data.name}"
        run = None if data.initial is None else compiler.typed(data.initial, kind, what)
        slot = compiler.new_slot()
        self._add_local(module, node, names, LocalSymbol(data.name, kind, data.storage, slot))

        def setup(frame: Frame) -> None:
            frame[slot] = default(kind) if run is None else copy(run(frame))

        return setup

    def _caller(
        self, file: str, node: s.Routine, info: RoutineInfo, setups: Sequence[Run], body: Step, slots: int
    ) -> Run:
        """Code that runs the routine on its argument slots."""
        context = self._context
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
                if outcome is None or outcome.value is None:
                    raise RapidStop(f"function {node.name} ended without RETURN")
                return outcome.value
            except (RapidFault, RapidStop) as problem:
                if not problem.file:
                    problem.file, problem.line = context.file, context.line
                raise
            finally:
                context.depth -= 1
                context.file, context.line = saved

        return call
