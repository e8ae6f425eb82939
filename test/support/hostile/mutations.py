"""Good bytes made bad in one seeded step: flipped, cut, repeated, or with a value that nobody means."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

#: Values in the place of a good one: not numbers, beyond every number, other types, tags, depth, foreign digits.
VALUES = (
    "",
    ".nan",
    "nan",
    ".inf",
    "-.inf",
    "1e400",
    "-1e308",
    "9" * 400,
    "9" * 5000,
    "1_000",
    "0x1F",
    "0o17",
    "1,5",
    "1.234,5",
    '1 1/2"',
    "12 in",
    "\u0663",
    "1e-320",
    "-0",
    "null",
    "~",
    "true",
    "[]",
    "{}",
    "[1, 2, 3]",
    "[[1], 2]",
    "{a: 1}",
    "'text'",
    '"a\\0b"',
    "2026-11-22",
    "!!python/object/apply:os.getcwd []",
    "!!python/name:os.system",
    "!!binary aGVsbG8=",
    "!!set {a, b}",
    "!!int x",
    "!!float []",
    "!unknown 1",
    "&a [*a]",
    "*nothing",
    "<<: {x: 1}",
    "? [1, 2] : 3",
    "[" * 3000,
    "{a: " * 3000,
    "- " * 3000,
    "=1+1",
    "=HYPERLINK(1)",
    "../../../etc/passwd",
    "/dev/zero",
    "a" * 100_000,
    "\u202e\ufeff\u0000",
    "<script>alert(1)</script>",
)
#: Nine references of nine references each, eight levels deep.
LAUGHS = "\n".join(
    ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    + [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 9)]
)
ENTITIES = (
    '<?xml version="1.0"?><!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {chr(98 + n)} "{f"&{chr(97 + n)};" * 10}">' for n in range(9))
    + '<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&j;">&x;</robot>'
)

_SCALAR = re.compile(rb"(?<=[:,;\[ \"'=])[ ]?[-\w.+]+(?=[\n,;\]}\"' ]|$)")


def _flip(data: bytes, draw: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(draw.choice((1, 3, 30))):
        if changed:
            changed[draw.randrange(len(changed))] = draw.randrange(256)
    return bytes(changed)


def _cut(data: bytes, draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


def _remove(data: bytes, draw: random.Random) -> bytes:
    first = draw.randrange(len(data) + 1)
    return data[:first] + data[first + draw.choice((1, 10, 1000)) :]


def _repeat(data: bytes, draw: random.Random) -> bytes:
    first = draw.randrange(len(data) + 1)
    part = data[first : first + draw.choice((1, 30, 3000))]
    return data[:first] + part * draw.choice((2, 20)) + data[first + len(part) :]


def _lines(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    place = draw.randrange(len(lines))
    step = draw.randrange(4)
    if step == 0:
        del lines[place]
    elif step == 1:
        lines.insert(place, lines[draw.randrange(len(lines))])
    elif step == 2:
        draw.shuffle(lines)
    else:
        lines[place] = b"\t " + lines[place]
    return b"\n".join(lines)


def _value(data: bytes, draw: random.Random) -> bytes:
    places = list(_SCALAR.finditer(data))
    if not places:
        return data
    place = draw.choice(places)
    value = draw.choice(VALUES).encode("utf-8", "surrogatepass")
    return data[: place.start()] + b" " + value + data[place.end() :]


def _foreign(data: bytes, draw: random.Random) -> bytes:
    text = data.decode("utf-8", "replace")
    return draw.choice(
        (
            b"",
            b"\0",
            b"\xff\xfe\x00",
            b"\n" * 1000,
            LAUGHS.encode(),
            LAUGHS.encode() + b"\n" + data,
            ENTITIES.encode(),
            text.encode("utf-16"),
            text.encode("utf-8-sig"),
            text.replace("\n", "\r\n").encode(),
            text.replace("\n", "\r").encode(),
            text.replace(".", ",").encode(),
            text.replace(":", "\0").encode(),
            b"PK\x03\x04" + data,
            data * 3,
        )
    )


STEPS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _flip,
    _cut,
    _remove,
    _repeat,
    _lines,
    _value,
    _value,
    _value,
    _foreign,
)


def mutated(data: bytes, draw: random.Random) -> bytes:
    """The bytes after one to three hostile steps."""
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        data = draw.choice(STEPS)(data, draw)
    return data
