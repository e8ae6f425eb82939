"""From lark's parse tree to the syntax tree; methods carry the names of the grammar's rules."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any, NoReturn

from lark import Token, Transformer, Tree, v_args
from lark.tree import Meta

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.errors import RapidSyntaxError, RapidUnsupportedError
from doormill_ros.simulation.controller.rapid.types import STRING_LENGTH

IDENTIFIER_LENGTH = 32  #: characters of a RAPID name

_ESCAPE = re.compile(r'""|\\\\|\\([0-9A-Fa-f]{2})')


#: What lark hands to a callback: tokens and what the callbacks below made. It knows no closer type.
Items = list[Any]
#: Data, statements and error handler of a routine.
_Body = tuple[tuple[s.Data, ...], s.Block, s.Block | None]


def _tuple(items: Items | tuple[Any, ...] | None) -> tuple[Any, ...]:
    return tuple(items) if items is not None else ()


def build(tree: Tree[Token], file: str) -> Any:
    """The syntax tree of a parse tree; `file` is what messages call the text.

    Raises:
        VisitError: Wraps the `RapidSyntaxError` or `RapidUnsupportedError` that names file and line.
    """
    return _Builder(file).transform(tree)


@v_args(meta=True)
class _Builder(Transformer[Token, Any]):  # type: ignore[misc]  # lark brings no types that hold
    """Builds the syntax tree of one file."""

    def __init__(self, file: str) -> None:
        """Remember what to call the file in messages."""
        super().__init__()
        self._file = file

    def _unsupported(self, what: str, line: int, instead: str) -> AbbError:
        return RapidUnsupportedError(
            f"{self._file}, line {line}: {what} is outside the executed subset of RAPID: {instead}",
            file=self._file,
            line=line,
            construct=what,
        )

    def _syntax(self, line: int, found: str, allowed: str) -> AbbError:
        return RapidSyntaxError(
            f"{self._file}, line {line}: found {found}, allowed is {allowed}: correct the module",
            file=self._file,
            line=line,
        )

    def NAME(self, token: Token) -> Token:
        if len(token) > IDENTIFIER_LENGTH:
            raise self._syntax(
                token.line, f"the name {str(token)!r}", f"at most {IDENTIFIER_LENGTH} characters"
            )
        return token

    # Expressions

    def number(self, meta: Meta, items: Items) -> s.Number:
        text = items[0].lower()
        value = float(int(text, 0)) if text[:2] in ("0x", "0b", "0o") else float(text)
        if not math.isfinite(value):
            raise self._syntax(meta.line, f"the number {items[0]}", "a number that a num or dnum holds")
        return s.Number(meta.line, value)

    def string(self, meta: Meta, items: Items) -> s.Text:
        def decode(match: re.Match[str]) -> str:
            return chr(int(match[1], 16)) if match[1] else match[0][0]

        value = _ESCAPE.sub(decode, items[0][1:-1])
        if len(value) > STRING_LENGTH:
            raise self._syntax(meta.line, f"a string of {len(value)} characters", f"at most {STRING_LENGTH}")
        if any(ord(character) > 255 for character in value):
            raise self._syntax(meta.line, f"the string {value!r}", "characters of ISO 8859-1")
        return s.Text(meta.line, value)

    def true(self, meta: Meta, _items: Items) -> s.Truth:
        return s.Truth(meta.line, True)

    def false(self, meta: Meta, _items: Items) -> s.Truth:
        return s.Truth(meta.line, False)

    def aggregate(self, meta: Meta, items: Items) -> s.Aggregate:
        return s.Aggregate(meta.line, tuple(_open(item) for item in items if item is not None))

    def group(self, _meta: Meta, items: Items) -> tuple[Any]:
        # A tuple of one marks "in parentheses" until the operator around it has looked at it.
        return (items[0],)

    def unary(self, meta: Meta, items: Items) -> s.Unary:
        operator, operand = items[0].upper(), items[1]
        if operator == "NOT" and isinstance(operand, s.Binary) and operand.operator == "AND":
            # NOT has the lowest priority in RAPID and the highest nearly everywhere else.
            raise self._unsupported("NOT before AND without parentheses", meta.line, "write (NOT a) AND b")
        return s.Unary(meta.line, operator, _open(operand))

    def binary(self, meta: Meta, items: Items) -> s.Binary:
        left, operator, right = items
        return s.Binary(meta.line, operator.upper(), _open(left), _open(right))

    def variable(self, meta: Meta, items: Items) -> s.Variable:
        name, indices, *parts = items
        return s.Variable(meta.line, str(name), _tuple(indices), tuple(parts))

    def part(self, meta: Meta, items: Items) -> s.Part:
        return s.Part(meta.line, str(items[0]), _tuple(items[1]))

    def dims(self, _meta: Meta, items: Items) -> tuple[s.Expression, ...]:
        return tuple(_open(item) for item in items)

    def function(self, meta: Meta, items: Items) -> s.Function:
        return s.Function(meta.line, str(items[0]), _tuple(items[1]))

    def arguments(self, _meta: Meta, items: Items) -> tuple[s.Argument, ...]:
        return tuple(argument for group in items for argument in group)

    def argument_group(self, _meta: Meta, items: Items) -> tuple[s.Argument, ...]:
        return tuple(items)

    def positional(self, meta: Meta, items: Items) -> s.Argument:
        return s.Argument(meta.line, "", _open(items[0]))

    def optional(self, meta: Meta, items: Items) -> s.Argument:
        return s.Argument(meta.line, str(items[0]), _open(items[1]))

    def forwarded(self, meta: Meta, items: Items) -> s.Argument:
        return s.Argument(meta.line, str(items[0]), None, str(items[1]))

    # Statements

    def block(self, _meta: Meta, items: Items) -> s.Block:
        return tuple(items)

    def assign(self, meta: Meta, items: Items) -> s.Assign:
        return s.Assign(meta.line, items[0], _open(items[1]))

    def call(self, meta: Meta, items: Items) -> s.Call:
        return s.Call(meta.line, str(items[0]), _tuple(items[1]))

    def if_block(self, meta: Meta, items: Items) -> s.If:
        condition, block, *rest = items
        otherwise = rest.pop()
        return s.If(meta.line, ((_open(condition), block), *rest), otherwise or ())

    def elseif(self, _meta: Meta, items: Items) -> tuple[s.Expression, s.Block]:
        return (_open(items[0]), items[1])

    def else_(self, _meta: Meta, items: Items) -> s.Block:
        block: s.Block = items[0]
        return block

    def if_compact(self, meta: Meta, items: Items) -> s.If:
        return s.If(meta.line, ((_open(items[0]), (items[1],)),), ())

    def for_loop(self, meta: Meta, items: Items) -> s.For:
        name, first, last, step, body = items
        return s.For(meta.line, str(name), _open(first), _open(last), _open(step), body)

    def while_loop(self, meta: Meta, items: Items) -> s.While:
        return s.While(meta.line, _open(items[0]), items[1])

    def test(self, meta: Meta, items: Items) -> s.Test:
        value, *cases, default = items
        return s.Test(meta.line, _open(value), tuple(cases), default or ())

    def case(self, _meta: Meta, items: Items) -> tuple[tuple[s.Expression, ...], s.Block]:
        return (tuple(_open(item) for item in items[:-1]), items[-1])

    def default(self, _meta: Meta, items: Items) -> s.Block:
        block: s.Block = items[0]
        return block

    def return_(self, meta: Meta, items: Items) -> s.Return:
        return s.Return(meta.line, _open(items[0]))

    def raise_(self, meta: Meta, items: Items) -> s.Raise:
        return s.Raise(meta.line, _open(items[0]))

    def retry(self, meta: Meta, _items: Items) -> s.Retry:
        return s.Retry(meta.line)

    def trynext(self, meta: Meta, _items: Items) -> s.TryNext:
        return s.TryNext(meta.line)

    def exit_(self, meta: Meta, _items: Items) -> s.Exit:
        return s.Exit(meta.line)

    def goto(self, meta: Meta, _items: Items) -> NoReturn:
        raise self._unsupported("GOTO", meta.line, "use IF, WHILE or FOR")

    def label(self, meta: Meta, _items: Items) -> NoReturn:
        raise self._unsupported("a label", meta.line, "use IF, WHILE or FOR")

    def connect(self, meta: Meta, items: Items) -> s.Connect:
        return s.Connect(meta.line, items[0], str(items[1]))

    def late_call(self, meta: Meta, _items: Items) -> NoReturn:
        raise self._unsupported("a call by name, %...%", meta.line, "call the procedure directly or use TEST")

    # Declarations

    def component(self, _meta: Meta, items: Items) -> tuple[str, str]:
        return (str(items[0]), str(items[1]))

    def record(self, meta: Meta, items: Items) -> s.Record:
        return s.Record(meta.line, str(items[0]), tuple(items[1:]))

    def alias(self, meta: Meta, items: Items) -> s.Alias:
        return s.Alias(meta.line, str(items[0]), str(items[1]))

    def storage(self, _meta: Meta, items: Items) -> str:
        return str(items[0]).upper()

    def data(self, meta: Meta, items: Items) -> s.Data:
        task, storage, type_name, name, dimensions, initial = items
        if task is not None and storage != "PERS":
            raise self._syntax(meta.line, f"TASK {storage}", "TASK PERS")
        return s.Data(meta.line, storage, str(type_name), str(name), _tuple(dimensions), _open(initial))

    def mode(self, _meta: Meta, items: Items) -> str:
        return str(items[0]).upper()

    def open_dims(self, _meta: Meta, items: Items) -> int:
        return len(items)

    def param(self, meta: Meta, items: Items) -> s.Parameter:
        mode, type_name, name, open_dimensions = items
        return s.Parameter(meta.line, str(name), str(type_name), mode or "IN", False, open_dimensions or 0)

    def optional_param(self, _meta: Meta, items: Items) -> list[s.Parameter]:
        names = tuple(item.name for item in items)
        return [
            s.Parameter(p.line, p.name, p.type_name, p.mode, True, p.open_dimensions, names) for p in items
        ]

    def param_group(self, _meta: Meta, items: Items) -> list[s.Parameter]:
        return [p for item in items for p in (item if isinstance(item, list) else [item])]

    def params(self, _meta: Meta, items: Items) -> tuple[s.Parameter, ...]:
        return tuple(p for group in items if group is not None for p in group)

    def on_error(self, _meta: Meta, items: Items) -> s.Block:
        return tuple(items)

    def on_undo(self, meta: Meta, _items: Items) -> NoReturn:
        raise self._unsupported("UNDO", meta.line, "clean up in ERROR")

    def on_backward(self, meta: Meta, _items: Items) -> NoReturn:
        raise self._unsupported("BACKWARD", meta.line, "leave it out")

    def body(self, _meta: Meta, items: Items) -> _Body:
        *items, handler, _undo, _backward = items
        data = tuple(item for item in items if isinstance(item, s.Data))
        return data, tuple(item for item in items if not isinstance(item, s.Data)), handler

    def proc(self, meta: Meta, items: Items) -> s.Routine:
        name, parameters, (data, body, handler) = items
        return s.Routine(meta.line, str(name), "", parameters, data, body, handler)

    def func(self, meta: Meta, items: Items) -> s.Routine:
        type_name, name, parameters, (data, body, handler) = items
        return s.Routine(meta.line, str(name), str(type_name), parameters, data, body, handler)

    def proc_signature(self, meta: Meta, items: Items) -> s.Routine:
        return s.Routine(meta.line, str(items[0]), "", items[1])

    def func_signature(self, meta: Meta, items: Items) -> s.Routine:
        return s.Routine(meta.line, str(items[1]), str(items[0]), items[2])

    def signature(self, _meta: Meta, items: Items) -> s.Routine:
        routine: s.Routine = items[0]
        return routine

    def trap(self, meta: Meta, items: Items) -> s.Routine:
        name, (data, body, handler) = items
        return s.Routine(meta.line, str(name), "", (), data, body, handler, trap=True)

    def attributes(self, _meta: Meta, items: Items) -> tuple[str, ...]:
        return tuple(str(item).upper() for item in items)

    def item(self, _meta: Meta, items: Items) -> s.Record | s.Alias | s.Data | s.Routine:
        local: Token | None = items[0]
        declaration: s.Record | s.Alias | s.Data | s.Routine = items[1]
        if local is not None and isinstance(declaration, s.Data | s.Routine):
            return replace(declaration, local=True)
        return declaration

    def module(self, meta: Meta, items: Items) -> s.Module:
        name, attributes, *declarations = items
        return s.Module(
            meta.line,
            str(name),
            _tuple(attributes),
            self._file,
            tuple(d for d in declarations if isinstance(d, s.Record | s.Alias)),
            tuple(d for d in declarations if isinstance(d, s.Data)),
            tuple(d for d in declarations if isinstance(d, s.Routine)),
        )


def _open(expression: Any) -> Any:
    """An expression without the mark of parentheses around it."""
    while isinstance(expression, tuple):
        expression = expression[0]
    return expression
