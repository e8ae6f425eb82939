"""Messages of any type, and good messages with some fields as nobody means them."""

from __future__ import annotations

import array
import copy
import importlib
import math
import random
import re
from collections.abc import Iterator
from typing import Any

FLOATS = (math.nan, math.inf, -math.inf, 0.0, -0.0, -1.0, 1e-320, 1e9, 1e308, -1e308)
TEXTS = (
    "",
    "\0",
    " ",
    "nan",
    "[" * 5000,
    '{"schema": ',
    '{"schema": NaN}',
    "null",
    "9" * 5000,
    "../../../etc/passwd",
    "<script>alert(1)</script>",
    "\u202e\ufeff\u0663",
    "%s%n{}{0.__class__}",
    "mono16",
    "bayer_rggb8",
    "rgb8",
    "equidistant",
    "map",
)
HUGE = 10_000_000  # characters, bytes
LONG = 3000  # elements
_INTEGER = re.compile(r"^(u?)int(\d+)$")
_REALS = ("float", "double")
_SEQUENCE = re.compile(r"^(sequence<(?P<element>[^,>]+)(, *\d+)?>|(?P<item>.+)\[(?P<size>\d+)\])$")


def _integers(kind: str) -> tuple[int, ...]:
    unsigned, bits = _INTEGER.match(kind).groups()  # type: ignore[union-attr]
    low = 0 if unsigned else -(1 << int(bits) - 1)
    high = (1 << int(bits) - (0 if unsigned else 1)) - 1
    return tuple(sorted({low, high, 0, 1, max(low, -1), high // 2}))


def _places(message: Any) -> Iterator[tuple[Any, str, str]]:
    """Message, field and type of every field, however deep."""
    for name, kind in message.get_fields_and_field_types().items():
        yield message, name, kind
        value = getattr(message, name)
        if hasattr(value, "get_fields_and_field_types"):
            yield from _places(value)
        elif isinstance(value, list) and value and hasattr(value[0], "get_fields_and_field_types"):
            yield from _places(value[0])
            yield from _places(value[-1])


def _scalar(kind: str, draw: random.Random) -> Any:
    if kind in _REALS:
        return draw.choice(FLOATS)
    if kind == "boolean":
        return draw.random() < 0.5
    if kind == "octet":
        return bytes([draw.randrange(256)])
    if kind == "string":
        return draw.choice(TEXTS) if draw.random() < 0.95 else "x" * HUGE
    return draw.choice(_integers(kind))


def _many(old: Any, element: str, draw: random.Random) -> Any:
    if isinstance(old, array.array) or element in ("uint8", "double"):
        code = old.typecode if isinstance(old, array.array) else "B" if element == "uint8" else "d"
        value = draw.choice((0, 255)) if code == "B" else draw.choice(FLOATS) if code == "d" else 0
        size = draw.choice((0, 1, len(old) // 2, max(0, len(old) - 1), LONG, HUGE if code == "B" else LONG))
        return array.array(code, [value]) * size
    values = list(old)
    if not values:
        return values
    return draw.choice(([], values[:1], values[:-1], values[::-1], values * 2, values[:1] * LONG))


def filled(kind: type[Any]) -> Any:
    """A message of a type of which none was recorded: every field has a value, every sequence two."""
    message = kind()
    for name, field in message.get_fields_and_field_types().items():
        setattr(message, name, _plain(getattr(message, name), field, _slot(kind, name)))
    return message


def _slot(kind: type[Any], name: str) -> Any:
    """What the type says of a field; of a sequence of messages its class can be asked for."""
    return dict(zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True))[name]


def _plain(old: Any, kind: str, slot: Any) -> Any:
    if hasattr(old, "get_fields_and_field_types"):
        return filled(type(old))
    sequence = _SEQUENCE.match(kind)
    if sequence is None:
        return {"string": "word", "boolean": True, "octet": b"\1"}.get(kind, 1.5 if kind in _REALS else 1)
    if sequence["size"] is not None:
        return old
    element = slot.value_type
    if hasattr(element, "namespaced_name"):
        package, group, word = element.namespaced_name()
        made = filled(getattr(importlib.import_module(f"{package}.{group}"), word))
        return [made, copy.deepcopy(made)]
    return [_plain(None, sequence["element"], element)] * 2


def hostile(message: Any, draw: random.Random) -> Any:
    """A copy with one to four fields changed."""
    changed = copy.deepcopy(message)
    for _ in range(draw.choice((1, 1, 2, 4))):
        owner, name, kind = draw.choice(list(_places(changed)))
        old = getattr(owner, name)
        sequence = _SEQUENCE.match(kind)
        if sequence is None:
            if not hasattr(old, "get_fields_and_field_types"):
                setattr(owner, name, _scalar(kind, draw))
        elif sequence["size"] is not None:  # of fixed length
            values = [_scalar(sequence["item"], draw) for _ in range(int(sequence["size"]))]
            setattr(owner, name, values)
        else:
            setattr(owner, name, _many(old, sequence["element"], draw))
    return changed
