"""Compile calls: arguments to parameters, for routines of the program and predefined ones."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.errors import RapidUnsupportedError
from doormill_ros.simulation.controller.rapid.expressions import Code, ExpressionCompiler
from doormill_ros.simulation.controller.rapid.scope import (
    ABSENT,
    Frame,
    LocalSymbol,
    ParameterInfo,
    RoutineInfo,
    Run,
    Symbol,
)
from doormill_ros.simulation.controller.rapid.types import (
    ANY,
    BOOL,
    CONDITION,
    SWITCH,
    Type,
    accepts,
    copy,
    is_composite,
)

#: Modes of a parameter and the storage of the data that may be handed to it.
_STORAGE = {"VAR": ("VAR",), "PERS": ("PERS",), "INOUT": ("VAR", "PERS", "INOUT")}


class CallCompiler(ExpressionCompiler):
    """Compiles calls."""

    def function(self, node: s.Function) -> Code:
        """Compile a function call."""
        if node.name.lower() == "present":
            return self._present(node)
        routine = self._routine(node)
        if routine.type is None:
            self.fail(node, f"{routine.name} is a procedure, allowed here is a function: call it alone")
        return Code(routine.type, self._call(node, routine))

    def procedure(self, node: s.Call) -> Run:
        """Compile a call of a procedure or instruction."""
        routine = self._routine(node)
        if routine.trap:
            self.fail(
                node, f"{routine.name} is a trap, allowed here is a procedure: connect it to an interrupt"
            )
        if routine.type is not None:
            self.fail(node, f"{routine.name} is a function, allowed here is a procedure: use its result")
        return self._call(node, routine)

    def _routine(self, node: s.Function | s.Call) -> RoutineInfo:
        found = self._routines.find(node.name)
        if isinstance(found, RoutineInfo):
            return found
        if self._names.find(node.name) is not None:
            self.fail(node, f"{node.name!r} is data, allowed here is a routine: correct the name")
        # It may be an instruction of the controller that is not simulated: that is no mistake of
        # the module, so it gets the error class that says so.
        raise RapidUnsupportedError(
            f"{self._file}, line {node.line}: routine {node.name!r} is neither loaded nor in the executed "
            "subset of RAPID: load its module, correct the name or use another instruction",
            file=self._file,
            line=node.line,
            construct=node.name,
        )

    def _call(self, node: s.Function | s.Call, routine: RoutineInfo) -> Run:
        binders = self._bind(node, routine)
        run = routine.run if routine.predefined else None
        if run is not None and len(binders) == 1:
            only = binders[0]
            return lambda frame: run([only(frame)])
        if run is not None and len(binders) == 3:
            first, second, third = binders
            return lambda frame: run([first(frame), second(frame), third(frame)])
        if run is not None:
            return lambda frame: run([bind(frame) for bind in binders])
        # The routine may be compiled later, so its code is looked up when it is called.
        return lambda frame: routine.run([bind(frame) for bind in binders])

    def _bind(self, node: s.Function | s.Call, routine: RoutineInfo) -> list[Run]:
        """Code for every slot of the callee's frame."""
        positional = [a for a in node.arguments if not a.name]
        named = {a.name.lower(): a for a in node.arguments if a.name}
        required = [p for p in routine.parameters if not p.optional]
        if len(positional) != len(required):
            names = ", ".join(p.name for p in required) or "none"
            self.fail(
                node, f"{routine.name} has {len(positional)} arguments, allowed are {len(required)} ({names})"
            )
        if len(named) != sum(1 for a in node.arguments if a.name):
            self.fail(node, f"{routine.name} is given an optional argument twice: leave one out")
        known = {p.name.lower() for p in routine.parameters if p.optional}
        for name, given in named.items():
            if name not in known:
                self._refuse_optional(node, routine, given)
        binders = []
        for parameter in routine.parameters:
            argument: s.Argument | None
            if parameter.optional:
                argument = named.get(parameter.name.lower())
                rivals = [n for n in parameter.alternatives if n.lower() in named]
                if len(rivals) > 1:
                    self.fail(node, f"{routine.name} is given {' and '.join(rivals)}, allowed is one of them")
            else:
                argument = positional.pop(0)
            binders.append(self._bind_one(node, routine, parameter, argument))
        return binders

    def _refuse_optional(self, node: s.Node, routine: RoutineInfo, argument: s.Argument) -> None:
        problem = f"{routine.name} has no optional argument \\{argument.name} in the executed subset of RAPID"
        if not routine.predefined:
            self.fail(node, f"{problem}: correct the call")
        raise RapidUnsupportedError(
            f"{self._file}, line {argument.line}: {problem}: leave it out",
            file=self._file,
            line=argument.line,
            construct=f"{routine.name}\\{argument.name}",
        )

    def _bind_one(
        self, node: s.Node, routine: RoutineInfo, parameter: ParameterInfo, argument: s.Argument | None
    ) -> Run:
        what = f"argument {parameter.name} of {routine.name}"
        missing: object = False if parameter.type == SWITCH else ABSENT
        if argument is None:
            return lambda frame: missing
        if argument.forwarded:
            return self._forward(argument, parameter, what)
        if parameter.type == SWITCH:
            if argument.value is not None:
                self.fail(argument, f"{what} has a value, allowed is the bare switch")
            return lambda frame: True
        if argument.value is None:
            self.fail(argument, f"{what} has no value, allowed is {parameter.type.name}")
        if parameter.type == CONDITION:
            condition = self.typed(argument.value, BOOL, what)
            return lambda frame: lambda: condition(frame)
        if isinstance(parameter.type, Type) and parameter.type.kind == "signal":
            return self._bind_signal(argument, parameter, what)
        if parameter.mode != "IN":
            return self._bind_reference(argument, parameter, what)
        if parameter.type is ANY:
            code = self.value(argument.value)
            kind, any_value = code.type, code.run
            return lambda frame: (any_value(frame), kind)
        run = self.typed(argument.value, parameter.type, what)
        if is_composite(parameter.type) and not routine.predefined:
            return lambda frame: copy(run(frame))
        return run

    def _bind_signal(self, argument: s.Argument, parameter: ParameterInfo, what: str) -> Run:
        node = argument.value
        symbol = self._names.find(node.name) if isinstance(node, s.Variable) else None
        if not isinstance(symbol, Symbol) or symbol.type != parameter.type:
            found = symbol.type.name if isinstance(symbol, Symbol) else "no configured signal"
            self.fail(
                argument,
                f"{what} is {found}, allowed is a configured {parameter.type.name}",
            )
        if symbol.storage != "SIGNAL" and isinstance(node, s.Variable):
            return self.reference_value(node)
        name = symbol.name
        return lambda frame: name

    def reference_value(self, node: s.Variable) -> Run:
        """Code for what a variable of a type without values holds, such as a signal parameter."""
        reference = self.reference(node)[1]

        def run(frame: Frame) -> object:
            container, index = reference(frame)
            return container[index]

        return run

    def _bind_reference(self, argument: s.Argument, parameter: ParameterInfo, what: str) -> Run:
        node = argument.value
        if not isinstance(node, s.Variable):
            self.fail(argument, f"{what} is an expression, allowed is data that can be changed")
        kind, reference, symbol = self.reference(node)
        if symbol.storage not in (*_STORAGE[parameter.mode], "IN" if parameter.mode != "PERS" else ""):
            allowed = " or ".join(_STORAGE[parameter.mode])
            self.fail(
                argument, f"{what} is {symbol.storage} {symbol.name}, allowed is {allowed}: declare it so"
            )
        if not accepts(parameter.type, kind):
            self.fail(argument, f"{what} is {kind.name}, allowed is {parameter.type.name}: correct it")
        if parameter.type is ANY:
            return lambda frame: (*reference(frame), kind)
        return reference

    def _forward(self, argument: s.Argument, parameter: ParameterInfo, what: str) -> Run:
        symbol = self._names.find(argument.forwarded)
        if not isinstance(symbol, LocalSymbol) or not symbol.optional:
            self.fail(argument, f"{what} forwards {argument.forwarded}, allowed is an optional one")
        if symbol.type != parameter.type or symbol.by_reference != (parameter.mode != "IN"):
            self.fail(
                argument,
                f"{what} forwards a {symbol.type.name}, allowed is {parameter.type.name}",
            )
        slot = symbol.slot
        return lambda frame: frame[slot]

    def _present(self, node: s.Function) -> Code:
        argument = node.arguments[0].value if len(node.arguments) == 1 else None
        symbol = self._names.find(argument.name) if isinstance(argument, s.Variable) else None
        if not isinstance(symbol, LocalSymbol) or not symbol.optional:
            self.fail(node, "Present takes one optional parameter of the routine: correct the argument")
        slot, switch = symbol.slot, symbol.type == SWITCH
        test: Callable[[Frame], bool] = (
            (lambda frame: frame[slot] is True) if switch else (lambda frame: frame[slot] is not ABSENT)
        )
        return Code(BOOL, test)
