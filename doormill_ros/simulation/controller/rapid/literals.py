"""Read a RAPID literal of a known type from a string, as StrToVal does."""

from __future__ import annotations

import re

from doormill_ros.simulation.controller.rapid.types import AnyType, ArrayType, Type, Value, float32

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]?\d+)?")
_TRUTH = re.compile(r"TRUE|FALSE", re.IGNORECASE)
_STRING = re.compile(r'"((?:[^"\\]|""|\\\\)*)"')


class _NoLiteralError(Exception):
    """The text is no literal of the type."""


def parse_literal(text: str, kind: AnyType) -> Value | None:
    """The value a text stands for, or None when it is no literal of that type.

    Blanks around the whole text are skipped, blanks within it are not. Records and arrays are
    written `[a,b]`, with as many items as the type has.
    """
    text = text.strip(" ")
    try:
        value, position = _read(text, 0, kind)
    except (_NoLiteralError, OverflowError):
        return None
    return value if position == len(text) else None


def _read(text: str, position: int, kind: AnyType) -> tuple[Value, int]:
    if isinstance(kind, ArrayType):
        rest = kind.dimensions[1:]
        inner: AnyType = ArrayType(kind.element, rest) if rest else kind.element
        return _read_items(text, position, [inner] * (kind.dimensions[0] or 0))
    match kind.kind:
        case "num" | "dnum":
            return _read_number(text, position, kind)
        case "bool":
            match = _expect(_TRUTH, text, position)
            return match[0].upper() == "TRUE", match.end()
        case "string":
            match = _expect(_STRING, text, position)
            return match[1].replace('""', '"').replace("\\\\", "\\"), match.end()
        case "record":
            return _read_items(text, position, [component for _, component in kind.components])
    raise _NoLiteralError


def _read_number(text: str, position: int, kind: Type) -> tuple[float, int]:
    match = _expect(_NUMBER, text, position)
    value = float(match[0])
    if kind.kind == "num":
        value = float32(value)
    if value in (float("inf"), float("-inf")):
        raise _NoLiteralError
    return value, match.end()


def _read_items(text: str, position: int, kinds: list[AnyType]) -> tuple[list[Value], int]:
    if not text.startswith("[", position):
        raise _NoLiteralError
    position += 1
    values = []
    for index, kind in enumerate(kinds):
        if index:
            if not text.startswith(",", position):
                raise _NoLiteralError
            position += 1
        value, position = _read(text, position, kind)
        values.append(value)
    if not text.startswith("]", position):
        raise _NoLiteralError
    return values, position + 1


def _expect(pattern: re.Pattern[str], text: str, position: int) -> re.Match[str]:
    match = pattern.match(text, position)
    if match is None:
        raise _NoLiteralError
    return match
