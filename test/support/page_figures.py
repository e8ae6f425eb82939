"""Figures of the pages and where each comes from: the files of test/figures, one a page, read and worked out.

`page` is the page; under `figures` stand its words, a `{}` for each figure, with the source of each (`number_of`);
under `cited` patterns of figures that no source holds, each with where it is from.
"""

from __future__ import annotations

import importlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.errors import catalogue
from support.source_tree import ROOT

TABLES = ROOT / "test" / "figures"
NOT_RECORDED = TABLES / "not_recorded.yaml"
RESULTS = ROOT / "bench" / "results"
COUNTED = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
WORDS = {
    **{word: float(number) for number, word in enumerate(COUNTED)},
    "half": 0.5,
    "quarter": 0.25,
    "twice": 2.0,
}
NUMBER = rf"([+-]?\d+(?:,\d{{3}})*(?:\.\d+)?|{'|'.join(WORDS)})"
#: What a page may say before a figure that is rounded more coarsely than its digits, and how coarsely.
ABOUT, COARSE = re.compile(r"\b(about|some)\b"), 0.1


@dataclass(frozen=True)
class Row:
    """Words of a page with `{}` for each figure, and the source of each."""

    page: str
    words: str
    sources: tuple[str, ...]

    @property
    def pattern(self) -> str:
        """What finds the words with any figures in a text of single spaces."""
        return re.escape(" ".join(self.words.split())).replace(re.escape("{}"), NUMBER)

    def said(self, text: str) -> list[str] | None:
        """The figures as a page's text has them; None when the words are not there just once."""
        found = list(re.finditer(self.pattern, " ".join(text.split())))
        return [str(figure) for figure in found[0].groups()] if len(found) == 1 else None

    def complaints(self, text: str) -> list[str]:
        """What a page's text says otherwise than the sources, a line each."""
        said = self.said(text)
        if said is None:
            return [f"{self.page} does not say just once: {self.words}"]
        if len(said) != len(self.sources):
            return [f"{self.page}: {len(said)} figures and {len(self.sources)} sources: {self.words}"]
        coarse = COARSE if ABOUT.search(self.words) else 0.0
        return [
            f"{self.page} says {text} in {self.words!r}, {source} is {value:g}"
            for text, source in zip(said, self.sources, strict=True)
            if not agrees(text, value := number_of(source), coarse)
        ]


def tables() -> list[dict[str, Any]]:
    """What the files say, one a page."""
    files = sorted(path for path in TABLES.glob("*.yaml") if path != NOT_RECORDED)
    return [yaml.safe_load(path.read_text(encoding="utf-8")) for path in files]


def rows() -> list[Row]:
    """The rows of all pages."""
    return [
        Row(table["page"], words, tuple(sources if isinstance(sources, list) else [sources]))
        for table in tables()
        for words, sources in table.get("figures", {}).items()
    ]


def not_recorded() -> dict[str, str]:
    """Benches whose figures the pages print, with no run of theirs in `bench/results`, and why."""
    return dict(yaml.safe_load(NOT_RECORDED.read_text(encoding="utf-8")))


def agrees(text: str, value: float, coarse: float) -> bool:
    """Whether a printed figure is the value, rounded to the digits that are printed."""
    if text in WORDS:
        return abs(WORDS[text] - value) <= 1e-9 + coarse * abs(value)
    digits = text.replace(",", "")
    unit = 10.0 ** -len(digits.partition(".")[2])
    return abs(float(digits) - value) <= 0.5 * unit * (1.0 + 1e-9) + coarse * abs(value)


def number_of(source: str) -> float:
    """What a source gives: `WHERE`, `WHERE * FACTOR` or `WHERE / DIVISOR`; WHERE is one of

    - `config/FILE.yaml#key.key`, an index for a list;
    - `errors#CLASS` or `errors#ROOM/CLASS`, the code of an error;
    - `PATH#PATTERN`, with one group that is found just once, in any other file of the repository: a bench's kept run, a
      module of RAPID, the bound of a test;
    - `module:NAME.attribute`, a function is called; `module:CLASS#parameter` for the default of a node's parameter.
    """
    match = re.fullmatch(r"(.*?)(?: ([*/]) (\S+))?", source)
    assert match is not None
    value = _value(match[1])
    factor = float(match[3]) if match[3] else 1.0
    return value / factor if match[2] == "/" else value * factor


def _value(where: str) -> float:
    place, _, key = where.partition("#")
    if place == "errors":
        (code,) = {entry.code for entry in catalogue() if key in (entry.name, f"{entry.room}/{entry.name}")}
        return float(code)
    if place.startswith("config/") and place.endswith(".yaml"):
        return float(_item(yaml.safe_load((ROOT / place).read_text(encoding="utf-8")), key))
    if (ROOT / place).is_file():
        (found,) = re.findall(key, (ROOT / place).read_text(encoding="utf-8"))
        return float(found)
    module, _, name = place.partition(":")
    found = _item(importlib.import_module(module), name)
    if key:
        found = next(parameter.default for parameter in found.PARAMETERS if parameter.name == key)
    return float(found() if callable(found) else found)


def _item(value: Any, path: str) -> Any:
    for key in path.split("."):
        if isinstance(value, dict):
            value = value[key]
        elif isinstance(value, list | tuple) and key.isdecimal():
            value = value[int(key)]
        else:
            value = getattr(value, key)
    return value


def results() -> list[Path]:
    """Recorded runs of benches."""
    return sorted(RESULTS.glob("*.txt"))
