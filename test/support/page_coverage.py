"""Figures of a page that nothing holds: neither a row of its file in test/figures nor what that lists as cited."""

from __future__ import annotations

import re

from support.page_figures import Row, tables

#: A number, not the digits of a name or of an exponent.
FIGURE = re.compile(r"(?<![\w.])(?<!\de-)\d+(?:[.,]\d+)*")
#: What a bench wrote into a page, in parts with a name where it is several, see test/test_figures.py.
WRITTEN = r"(?s)<!-- begin: bench/(\w+)\.py ?(\w*) -->\n(.*?)\n<!-- end -->"
#: What a page shows and does not say: code, names, addresses, the counting of lists and headings.
SHOWN = (
    WRITTEN,
    r"(?ms)^```.*?^```",
    r"(?m)^(?: {4,}|\t)(?![-*\d ]).*$",
    r"`[^`\n]*(?:\n[^`\n]*)?`",
    r"\]\([^)]*\)",
    r"\b127\.0\.0\.1\b",
    r"(?m)^\s*\d+\. ",
    r"(?m)^#+ \d+\. ",
)


def cited() -> dict[str, dict[str, str]]:
    """Of each page that is looked through: patterns of figures that no row can hold, and why."""
    return {table["page"]: table["cited"] for table in tables() if "cited" in table}


def uncovered(page: str, text: str, rows: list[Row], patterns: dict[str, str]) -> list[str]:
    """Figures of a page's text, each with the words about it, that neither its rows nor the patterns cover."""
    said = _flat(text)
    shown = _flat(_masked(text))
    spans = [span for row in rows if row.page == page for span in _spans(row.pattern, said)]
    spans += [span for pattern in patterns for span in _spans(pattern, shown)]
    return [
        said[max(0, figure.start() - 40) : figure.end() + 30]
        for figure in FIGURE.finditer(shown)
        if not any(start <= figure.start() and figure.end() <= end for start, end in spans)
    ]


def _spans(pattern: str, text: str) -> list[tuple[int, int]]:
    return [match.span() for match in re.finditer(pattern, text)]


def _masked(text: str) -> str:
    for pattern in SHOWN:
        text = re.sub(pattern, lambda match: re.sub(r"\d", "#", match[0]), text)
    return text


def _flat(text: str) -> str:
    return " ".join(text.split())
