"""Whether a refusal says where in the file the trouble is: line, row, cell or key."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import yaml

#: Of a parser, of a table, of a text that is no text.
_PLACE = re.compile(r"\b(line|row|column|byte|position|sheet|document|entry)s? '?[\w.]+")
#: It is the file as a whole: empty, too large, no mapping, no file of its kind, or without a place to name.
_WHOLE = re.compile(
    r"holds nothing|holds no mapping|found None|it holds|has schema|schema is|nested too deeply|unpacks to"
    r"|not an Excel workbook"
    r"|: is given twice|steady window lasts|no row is about a door"
    r"|more than \d+ bytes|allowed are fields with names|NUL"
)


def keys_of(document: Any) -> set[str]:
    """Every key of a document, however deep."""
    found: set[str] = set()
    if isinstance(document, dict):
        for key, value in document.items():
            found |= {str(key)} | keys_of(value)
    elif isinstance(document, list):
        for value in document:
            found |= keys_of(value)
    return found


def good_keys(path: Path, form: str) -> set[str]:
    """Keys of a good file."""
    text = path.read_text(encoding="utf-8-sig")
    return keys_of(json.loads(text) if form == "json" else yaml.safe_load(text))


def placed(sentence: str, folder: Path, file: str, keys: set[str]) -> bool:
    """Whether a sentence names a place beside the file's name."""
    text = sentence.replace(str(folder), "").replace(file, "")
    if _PLACE.search(text) or _WHOLE.search(text):
        return True
    return any(re.search(rf"(?<![A-Za-z0-9_]){re.escape(key)}(?![A-Za-z0-9_])", text) for key in keys)
