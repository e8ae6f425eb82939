"""Compile RAPID expressions into Python functions of the frame, with their static types."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.operators import find_operation, num
from doormill_ros.simulation.controller.rapid.scope import (
    ABSENT,
    Frame,
    GlobalSymbol,
    LocalSymbol,
    Names,
    Refer,
    Reference,
    Run,
    Symbol,
    program_error,
)
from doormill_ros.simulation.controller.rapid.types import (
    BOOL,
    DNUM,
    NUM,
    POS,
    STRING,
    SWITCH,
    AnyType,
    ArrayType,
    Type,
    Value,
    float32,
    is_integer,
)


@dataclass(frozen=True)
class Code:
    """A compiled expression."""

    type: AnyType
    run: Run


class ExpressionCompiler:
    """Compiles the expressions of one module."""

    def __init__(self, file: str, context: Context, names: Names, routines: Names, types: Names) -> None:
        """Compile for a file with what is visible in it."""
        self._file = file
        self._context = context
        self._names = names
        self._routines = routines
        self._types = types

    def fail(self, node: s.Node, problem: str) -> NoReturn:
        """Refuse the module."""
        raise program_error(self._file, node.line, problem)

    def value(self, node: s.Expression, expected: AnyType | None = None) -> Code:
        """Compile an expression; `expected` gives aggregates and literals their type."""
        match node:
            case s.Number():
                return self._number(node, expected)
            case s.Text():
                return _constant(STRING, node.value)
            case s.Truth():
                return _constant(BOOL, node.value)
            case s.Aggregate():
                return self._aggregate(node, expected)
            case s.Variable():
                return self._variable(node)
            case s.Unary():
                return self._unary(node, expected)
            case s.Binary():
                return self._binary(node, expected)
            case s.Function():
                return self.function(node)
        raise TypeError(f"no expression: {node!r}")

    def typed(self, node: s.Expression, expected: AnyType, what: str) -> Run:
        """Compile an expression that must have a certain type."""
        code = self.value(node, expected)
        if code.type != expected and not _same_shape(code.type, expected):
            self.fail(node, f"{what} is {code.type.name}, allowed is {expected.name}: correct the expression")
        return code.run

    def function(self, node: s.Function) -> Code:
        """Compile a function call."""
        raise NotImplementedError

    def symbol(self, node: s.Variable) -> Symbol:
        """The symbol a variable begins with."""
        found = self._names.find(node.name)
        if not isinstance(found, Symbol):
            self.fail(
                node,
                f"{node.name!r} is not declared: declare it or correct the name",
            )
        return found

    def reference(self, node: s.Variable) -> tuple[AnyType, Refer, Symbol]:
        """Compile a variable into code that gives its `Reference`."""
        symbol = self.symbol(node)
        kind: AnyType = symbol.type
        steps: list[int | Run] = []
        kind = self._index(node, node.name, kind, node.indices, steps)
        for part in node.parts:
            found = kind.component(part.name) if isinstance(kind, Type) else None
            if found is None:
                self.fail(part, f"{kind.name} has no component {part.name!r}: correct the name")
            steps.append(found[0])
            kind = self._index(part, part.name, found[1], part.indices, steps)
        return kind, _follow(self._base(symbol), steps), symbol

    def _base(self, symbol: Symbol) -> Refer:
        if isinstance(symbol, GlobalSymbol):
            place = symbol.store, 0
            return lambda frame: place
        if not isinstance(symbol, LocalSymbol):
            raise TypeError(f"{symbol.name} is neither in the program nor in a frame")
        slot, name = symbol.slot, symbol.name

        def own(frame: Frame) -> Reference:
            return frame, slot

        def callers(frame: Frame) -> Reference:
            reference: Reference = frame[slot]
            return reference

        find = callers if symbol.by_reference else own
        if not symbol.optional:
            return find

        def checked(frame: Frame) -> Reference:
            if frame[slot] is ABSENT:
                raise RapidFault("ERR_NOTPRES", f"optional argument {name} was not given")
            return find(frame)

        return checked

    def _index(
        self,
        node: s.Node,
        name: str,
        kind: AnyType,
        indices: tuple[s.Expression, ...],
        steps: list[int | Run],
    ) -> AnyType:
        """Append the steps of `{i,j}` and give the type of what is found there."""
        if not indices:
            return kind
        if not isinstance(kind, ArrayType) or len(indices) != len(kind.dimensions):
            rank = len(kind.dimensions) if isinstance(kind, ArrayType) else 0
            self.fail(node, f"{name!r} has {rank} dimensions, found are {len(indices)} indices")
        steps.extend(self.typed(index, NUM, "the index") for index in indices)
        return kind.element

    def _number(self, node: s.Number, expected: AnyType | None) -> Code:
        if expected == DNUM:
            return _constant(DNUM, node.value)
        try:
            return _constant(NUM, float32(node.value))
        except OverflowError:
            self.fail(node, f"{node.value:g} is beyond the range of num: use a smaller number or dnum")

    def _aggregate(self, node: s.Aggregate, expected: AnyType | None) -> Code:
        if isinstance(expected, ArrayType):
            rest = expected.dimensions[1:]
            inner: AnyType = ArrayType(expected.element, rest) if rest else expected.element
            length = expected.dimensions[0]
            kinds = [inner] * (len(node.items) if length is None else length)
        elif isinstance(expected, Type) and expected.kind == "record":
            kinds = [component for _, component in expected.components]
        else:
            self.fail(node, "the type of [...] is not known here: assign it to data of its type first")
        if len(node.items) != len(kinds):
            self.fail(
                node,
                f"[...] has {len(node.items)} items, {expected.name} has {len(kinds)}: correct the number",
            )
        runs = [self.typed(item, kind, "the item") for item, kind in zip(node.items, kinds, strict=True)]
        return Code(expected, lambda frame: [run(frame) for run in runs])

    def _variable(self, node: s.Variable) -> Code:
        symbol = self.symbol(node)
        if symbol.storage == "SIGNAL":
            machine, name = self._context.machine, symbol.name
            return Code(NUM, lambda frame: machine.read_signal(name))
        if symbol.type == SWITCH:
            self.fail(
                node, f"{symbol.name} is a switch, allowed is Present({symbol.name}): correct the expression"
            )
        kind, reference, symbol = self.reference(node)
        whole = not node.indices and not node.parts
        if whole and isinstance(symbol, GlobalSymbol):
            store = symbol.store
            return Code(kind, lambda frame: store[0])
        if whole and isinstance(symbol, LocalSymbol) and not symbol.optional and not symbol.by_reference:
            slot = symbol.slot
            return Code(kind, lambda frame: frame[slot])

        def run(frame: Frame) -> Value:
            container, index = reference(frame)
            return container[index]

        return Code(kind, run)

    def _unary(self, node: s.Unary, expected: AnyType | None) -> Code:
        code = self.value(node.operand, expected)
        run = code.run
        if node.operator == "NOT" and code.type == BOOL:
            return Code(BOOL, lambda frame: not run(frame))
        if node.operator == "+" and code.type in (NUM, DNUM, POS):
            return code
        if node.operator == "-" and code.type in (NUM, DNUM):
            # A zero must not become the negative zero, which RAPID would print like any zero.
            return Code(code.type, lambda frame: 0.0 - run(frame))
        if node.operator == "-" and code.type == POS:
            return Code(POS, lambda frame: [0.0 - item for item in run(frame)])
        self.fail(node, f"{node.operator} does not take {code.type.name}: correct the expression")

    def _binary(self, node: s.Binary, expected: AnyType | None) -> Code:
        hint = expected if node.operator in ("+", "-", "*", "/", "DIV", "MOD") else None
        hint = hint if hint == DNUM else None
        if isinstance(node.left, s.Aggregate | s.Number) and not isinstance(node.right, s.Aggregate):
            right = self.value(node.right, hint)
            left = self.value(node.left, hint or right.type)
        else:
            left = self.value(node.left, hint)
            right = self.value(node.right, hint or left.type)
        found = find_operation(node.operator, left.type, right.type)
        if found is None:
            self.fail(
                node,
                f"{node.operator} does not take {left.type.name} and {right.type.name}: correct it",
            )
        kind, operation = found
        first, second = left.run, right.run
        return Code(kind, lambda frame: operation(first(frame), second(frame)))


def _constant(kind: AnyType, value: object) -> Code:
    return Code(kind, lambda frame: value)


def _same_shape(found: AnyType, expected: AnyType) -> bool:
    """An array of known length where one of open length is expected."""
    return (
        isinstance(found, ArrayType)
        and isinstance(expected, ArrayType)
        and found.element == expected.element
        and len(found.dimensions) == len(expected.dimensions)
        and None in expected.dimensions
    )


def _follow(base: Refer, steps: list[int | Run]) -> Refer:
    """Code that walks from a piece of data to one of its parts."""
    if not steps:
        return base

    def run(frame: Frame) -> Reference:
        container, index = base(frame)
        for step in steps:
            container = container[index]
            index = step if isinstance(step, int) else _checked_index(step(frame), len(container))
        return container, index

    return run


def _checked_index(value: float, length: int) -> int:
    if not is_integer(value) or not 1 <= value <= length:
        raise RapidFault("ERR_OUTOFBND", f"index {num(value):g} of an array of {length}")
    return int(value) - 1
