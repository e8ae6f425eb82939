"""Other spellings of one content: order of keys, comments, white space, notation of numbers, YAML as JSON."""

from __future__ import annotations

import csv
import io
import json
import random
import re
import zipfile
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree

import yaml

LARGEST = 200_000  # bytes of a text that is spelt anew
_PLAIN_FLOAT = re.compile(r"[-+]?\d+\.\d+")
_CSV_FLOAT = re.compile(r"-?\d+\.\d+")
_FORMS = {".yml": "yaml", ".yaml": "yaml", ".json": "json", ".csv": "csv", ".xlsx": "xlsx", ".urdf": "xml"}


class CannotSpellError(ValueError):
    """No other spelling is known of this content."""


def form_of(name: str) -> str:
    """What a file's ending says it is written in, empty for none that is known here."""
    return next((form for ending, form in _FORMS.items() if name.endswith(ending)), "")


def spelt_anew(data: bytes, form: str, draw: random.Random) -> bytes:
    """The same content in another spelling.

    Raises:
        CannotSpellError: It is no text of that form, or of none that is known here.
    """
    if form not in _WAYS or len(data) > LARGEST:
        raise CannotSpellError(form)
    if form == "xlsx":
        return _workbook(data, draw)
    try:
        text = _WAYS[form](data.decode("utf-8-sig"), draw)
    except CannotSpellError:
        raise
    except Exception as error:  # parsers say in many ways that a spoilt text is none of theirs
        raise CannotSpellError(str(error)) from error
    ends = draw.choice(("\n", "\n", "\r\n"))
    return draw.choice((b"", b"", b"\xef\xbb\xbf")) + text.replace("\n", ends).encode()


def _number(text: str, draw: random.Random) -> str:
    """A number with a point in another notation."""
    new = draw.choice(
        (text, f"{text}0", text.replace(".", ".", 1), f"{float(text):.17e}", f"{float(text)!r}")
    )
    return new if float(new) == float(text) and "." in new else text


def _yaml(text: str, draw: random.Random) -> str:
    plain = yaml.safe_load(text)
    if not isinstance(plain, dict | list):
        raise CannotSpellError("no document")
    if draw.random() < 0.25:
        return json.dumps(plain, indent=draw.choice((None, 1, 4)), allow_nan=False)
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    _turn(root, draw, set())
    flow = draw.choice((None, None, True, False))
    new = yaml.serialize(
        root, Dumper=yaml.SafeDumper, width=draw.choice((40, 100, 10_000)), indent=draw.choice((2, 4))
    )
    if flow is None and "|" not in new and ">" not in new and '"' not in new and "'" not in new:
        new = "".join(
            f"{line}   # {draw.random()}\n" if draw.random() < 0.3 else f"{line}\n"
            for line in new.splitlines()
        )
        new = f"# {draw.random()}\n\n{new}\n\n# end"
    if yaml.safe_load(new) != plain:
        raise CannotSpellError("NaN, or a comment in a text")
    return new


def _turn(node: Any, draw: random.Random, seen: set[int]) -> None:
    if id(node) in seen:
        return
    seen.add(id(node))
    if isinstance(node, yaml.ScalarNode):
        if node.tag.endswith(":float") and _PLAIN_FLOAT.fullmatch(node.value):
            node.value = _number(node.value, draw)
        return
    node.flow_style = draw.choice((node.flow_style, True))
    if isinstance(node, yaml.MappingNode):
        names = [name.value for name, _ in node.value]
        if len(set(names)) == len(names):
            draw.shuffle(node.value)
        for name, value in node.value:
            _turn(name, draw, seen)
            _turn(value, draw, seen)
    else:
        for value in node.value:
            _turn(value, draw, seen)


def _json(text: str, draw: random.Random) -> str:
    document = json.loads(text, object_pairs_hook=_once)
    if not isinstance(document, dict | list):
        raise CannotSpellError("no document")
    separators = draw.choice(((",", ":"), (" , ", " : ")))
    return json.dumps(
        _shuffled(document, draw),
        indent=draw.choice((None, 0, 3)),
        ensure_ascii=draw.random() < 0.5,
        separators=separators,
        allow_nan=False,
    )


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(dict(pairs)) < len(pairs):
        raise CannotSpellError("a key twice")
    return dict(pairs)


def _shuffled(value: Any, draw: random.Random) -> Any:
    if isinstance(value, list):
        return [_shuffled(item, draw) for item in value]
    if isinstance(value, dict):
        items = [(key, _shuffled(item, draw)) for key, item in value.items()]
        draw.shuffle(items)
        return dict(items)
    return value


def _csv(text: str, draw: random.Random) -> str:
    if "\r" in text.replace("\r\n", "") or "#" in text or "%" in text or ";" in text or "\t" in text:
        raise CannotSpellError("other line ends or comments")
    rows = [row for row in csv.reader(io.StringIO(text), strict=True) if any(cell.strip() for cell in row)]
    if len({len(row) for row in rows}) != 1:
        raise CannotSpellError("rows of several lengths")
    if len({cell.strip() for cell in rows[0]}) < len(rows[0]) or any(_CSV_FLOAT.search(c) for c in rows[0]):
        raise CannotSpellError("no header")
    order = list(range(len(rows[0])))
    draw.shuffle(order)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    for row in rows:
        writer.writerow([_number(row[i], draw) if _CSV_FLOAT.fullmatch(row[i]) else row[i] for i in order])
        if draw.random() < 0.05:
            stream.write("\n")
    return stream.getvalue()


def _xml(text: str, draw: random.Random) -> str:
    root = ElementTree.fromstring(text)
    for element in root.iter():
        items = list(element.attrib.items())
        draw.shuffle(items)
        element.attrib.clear()
        element.attrib.update(items)
    if draw.random() < 0.5:
        ElementTree.indent(root, " " * draw.randrange(8))
    text = ElementTree.tostring(root, encoding="unicode")
    return draw.choice(("", "<?xml version='1.0'?>\n<!-- a -->")) + text + draw.choice(("", "\n<!-- b -->\n"))


def _workbook(data: bytes, draw: random.Random) -> bytes:
    """Parts in another order and packed otherwise, attributes of every element in another order."""
    stream = io.BytesIO()
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, "w") as new:
            names = old.namelist()
            if sum(item.file_size for item in old.infolist()) > LARGEST or len(set(names)) < len(names):
                raise CannotSpellError("too large")
            draw.shuffle(names)
            for name in names:
                content = old.read(name)
                kind = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))
                if name.startswith("xl/worksheets/sheet"):
                    content = _sheet(content.decode(), draw)
                new.writestr(name, content, kind)
    except (
        zipfile.BadZipFile,
        OSError,
        ValueError,
        KeyError,
        NotImplementedError,
        ElementTree.ParseError,
    ) as error:
        raise CannotSpellError(str(error)) from error
    except Exception as error:  # zlib and lzma each have errors of their own
        raise CannotSpellError(str(error)) from error
    return stream.getvalue()


_CELL = re.compile(r"(<v>)(-?\d+\.\d+)(</v>)")


def _sheet(text: str, draw: random.Random) -> bytes:
    ElementTree.fromstring(text)
    return _CELL.sub(lambda found: found[1] + _number(found[2], draw) + found[3], text).encode()


_WAYS: dict[str, Callable[[str, random.Random], str] | None] = {
    "yaml": _yaml,
    "json": _json,
    "csv": _csv,
    "xml": _xml,
    "xlsx": None,
}
