"""Workbooks made bad inside: the zip is whole, a part of it holds what nobody means."""

from __future__ import annotations

import io
import random
import re
import zipfile
from collections.abc import Callable

from support.hostile.mutations import ENTITIES, VALUES, mutated

_VALUE = re.compile(r"(?<=<v>)[^<]*|(?<=<t>)[^<]*")
_CELL = re.compile(r"<c [^>]*?(/>|>.*?</c>)", re.S)
_KIND = re.compile(r'(<c [^>]*?)( t="\w+")?(/?>)')
_PLACE = re.compile(r'(?<= r=")[A-Z]+\d+(?=")')
_KINDS = ("s", "n", "b", "e", "str", "inlineStr", "d", "x", "")
_PLACES = ("A1", "B1", "ZZZ9999999", "XFD1048576", "A0", "1A", "", "AAAAA1", "A99999999999999999999")
_TEXTS = (
    "&#1632;",
    "&lt;b&gt;",
    "&x;",
    "&#0;",
    "#REF!",
    "#N/A",
    "1E400",
    "1e-7",
    "45000",
    "TRUE",
    "2026-11-22",
)
_DOCTYPE = '<!DOCTYPE r [<!ENTITY x "1"><!ENTITY y SYSTEM "file:///etc/passwd">]>'


def _one(pattern: re.Pattern[str], text: str, draw: random.Random, new: str) -> str:
    places = list(pattern.finditer(text))
    if not places:
        return text
    place = draw.choice(places)
    return text[: place.start()] + new + text[place.end() :]


def _value(text: str, draw: random.Random) -> str:
    hostile = draw.choice(VALUES).replace("&", "&amp;").replace("<", "&lt;").replace("\0", "")
    return _one(_VALUE, text, draw, draw.choice((hostile, draw.choice(_TEXTS), str(draw.randrange(-2, 500)))))


def _kind(text: str, draw: random.Random) -> str:
    places = list(_KIND.finditer(text))
    if not places:
        return text
    place, kind = draw.choice(places), draw.choice(_KINDS)
    new = place[1] + (f' t="{kind}"' if kind else "") + place[3]
    return text[: place.start()] + new + text[place.end() :]


def _place(text: str, draw: random.Random) -> str:
    return _one(_PLACE, text, draw, draw.choice(_PLACES))


def _formula(text: str, draw: random.Random) -> str:
    return re.sub("<v>", lambda v: draw.choice((v[0], "<f>1+1</f><v>", '<f t="shared" si="9"/><v>')), text)


def _merged(text: str, draw: random.Random) -> str:
    place = draw.choice(("A1:B2", "B2:D2", "B2:B3", "A1:XFD1048576", "x", "D2:B1"))
    merge = f'<mergeCells count="1"><mergeCell ref="{place}"/></mergeCells>'
    return text.replace("</sheetData>", f"</sheetData>{merge}", 1)


def _gone(text: str, draw: random.Random) -> str:
    return _one(_CELL, text, draw, "")


def _entity(text: str, draw: random.Random) -> str:
    head, _, rest = text.partition("?>")
    spoilt = f"{head}?>{_DOCTYPE}{rest}" if rest else f"{_DOCTYPE}{text}"
    return draw.choice((ENTITIES, spoilt, _one(_VALUE, spoilt, draw, draw.choice(("&x;", "&y;")))))


def _bytes(text: str, draw: random.Random) -> str:
    return mutated(text.encode(), draw).decode("latin-1")


STEPS: tuple[Callable[[str, random.Random], str], ...] = (
    _value,
    _value,
    _value,
    _kind,
    _kind,
    _place,
    _formula,
    _merged,
    _gone,
    _entity,
    _bytes,
)


def mutated_inside(data: bytes, draw: random.Random) -> bytes:
    """A whole workbook of which one or two parts went through one or two hostile steps."""
    with zipfile.ZipFile(io.BytesIO(data)) as old:
        parts = {name: old.read(name) for name in old.namelist()}
    likely = [name for name in parts if "worksheets/sheet" in name or "sharedStrings" in name]
    for _ in range(draw.choice((1, 1, 2))):
        name = draw.choice(likely) if draw.random() < 0.85 else draw.choice(list(parts))
        text = parts[name].decode("utf-8", "replace")
        parts[name] = draw.choice(STEPS)(text, draw).encode("utf-8", "replace")
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as new:
        for name, content in parts.items():
            new.writestr(name, content)
    return stream.getvalue()
