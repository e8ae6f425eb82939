"""What RAPID's operators do, by the types of their operands."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.types import (
    BOOL,
    DNUM,
    NUM,
    ORIENT,
    POS,
    STRING,
    STRING_LENGTH,
    AnyType,
    float32,
    is_integer,
    is_value,
)

Operation = Callable[[Any, Any], Any]


def num(value: float) -> float:
    """A result as a num holds it.

    Raises:
        RapidFault: ERR_NUM_LIMIT beyond float32.
    """
    try:
        return float32(value)
    except OverflowError:
        raise RapidFault("ERR_NUM_LIMIT", f"{value:g} is beyond the range of num") from None


def join(left: str, right: str) -> str:
    """Two strings in one.

    Raises:
        RapidFault: ERR_STRTOOLNG beyond 80 characters.
    """
    if len(left) + len(right) > STRING_LENGTH:
        raise RapidFault(
            "ERR_STRTOOLNG",
            f"a string of {len(left) + len(right)} characters, a RAPID string holds {STRING_LENGTH}",
        )
    return left + right


def find_operation(sign: str, left: AnyType, right: AnyType) -> tuple[AnyType, Operation] | None:
    """Type of the result and the function, or None when the operator does not take these types."""
    if sign in ("=", "<>"):
        if left != right or not is_value(left):
            return None
        return BOOL, operator.eq if sign == "=" else operator.ne
    if sign in _ORDER:
        return (BOOL, _ORDER[sign]) if left == right and left in (NUM, DNUM) else None
    if sign in _LOGIC:
        return (BOOL, _LOGIC[sign]) if left == right == BOOL else None
    return _ARITHMETIC.get((sign, left.name, right.name))


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise RapidFault("ERR_DIVZERO", "division by zero")
    return a / b


def _integers(a: float, b: float, sign: str) -> tuple[int, int]:
    if not (is_integer(a) and is_integer(b)):
        raise RapidFault("ERR_ARGVALERR", f"{a:g} {sign} {b:g}: {sign} takes integers")
    if b == 0.0:
        raise RapidFault("ERR_DIVZERO", f"{sign} by zero")
    return int(a), int(b)


def _div(a: float, b: float) -> float:
    x, y = _integers(a, b, "DIV")
    return float(abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1))


def _mod(a: float, b: float) -> float:
    x, y = _integers(a, b, "MOD")
    return float(abs(x) % abs(y) * (1 if x >= 0 else -1))


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [
        num(a[1] * b[2] - a[2] * b[1]),
        num(a[2] * b[0] - a[0] * b[2]),
        num(a[0] * b[1] - a[1] * b[0]),
    ]


def _orient_product(a: list[float], b: list[float]) -> list[float]:
    w, x, y, z = a
    u, i, j, k = b
    return [
        num(w * u - x * i - y * j - z * k),
        num(w * i + x * u + y * k - z * j),
        num(w * j - x * k + y * u + z * i),
        num(w * k + x * j - y * i + z * u),
    ]


_ORDER: dict[str, Operation] = {
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
}
# Both operands are evaluated: a program must not count on the right one being skipped.
_LOGIC: dict[str, Operation] = {"AND": operator.and_, "OR": operator.or_, "XOR": operator.xor}

_ARITHMETIC: dict[tuple[str, str, str], tuple[AnyType, Operation]] = {
    ("+", "num", "num"): (NUM, lambda a, b: num(a + b)),
    ("-", "num", "num"): (NUM, lambda a, b: num(a - b)),
    ("*", "num", "num"): (NUM, lambda a, b: num(a * b)),
    ("/", "num", "num"): (NUM, lambda a, b: num(_divide(a, b))),
    ("DIV", "num", "num"): (NUM, _div),
    ("MOD", "num", "num"): (NUM, _mod),
    ("+", "dnum", "dnum"): (DNUM, operator.add),
    ("-", "dnum", "dnum"): (DNUM, operator.sub),
    ("*", "dnum", "dnum"): (DNUM, operator.mul),
    ("/", "dnum", "dnum"): (DNUM, _divide),
    ("DIV", "dnum", "dnum"): (DNUM, _div),
    ("MOD", "dnum", "dnum"): (DNUM, _mod),
    ("+", "string", "string"): (STRING, join),
    ("+", "pos", "pos"): (POS, lambda a, b: [num(x + y) for x, y in zip(a, b, strict=True)]),
    ("-", "pos", "pos"): (POS, lambda a, b: [num(x - y) for x, y in zip(a, b, strict=True)]),
    ("*", "pos", "num"): (POS, lambda a, b: [num(x * b) for x in a]),
    ("*", "num", "pos"): (POS, lambda a, b: [num(a * x) for x in b]),
    ("*", "pos", "pos"): (POS, _cross),
    ("*", "orient", "orient"): (ORIENT, _orient_product),
}
