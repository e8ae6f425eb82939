"""The languages of the page, and what a run came to in each of them."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any, Literal, get_args

from doormill_ros.errors import DoormillError
from doormill_ros.operator.views.ended_run import EndedRun

#: Of the page's texts; what the cell's nodes say in their own words is English.
Language = Literal["en", "de", "nb"]
LANGUAGES: tuple[Language, ...] = get_args(Language)


def outcome_in(language: Language, run: EndedRun) -> str:
    """What the page calls the outcome of a run in one of `LANGUAGES`."""
    return _texts(language)[f"outcome.{run.came_to}"].replace("{code}", str(run.error_code))


def headline_in(language: Language, error_code: int) -> str:
    """What the page says above an error's own sentence in one of `LANGUAGES`; empty for 0, which is none."""
    headlines = _headlines(language)
    return headlines.get(error_code, headlines[DoormillError.code]) if error_code else ""


@cache
def _texts(language: Language) -> dict[str, str]:
    texts: dict[str, str] = _document(language)
    return texts


@cache
def _headlines(language: Language) -> dict[int, str]:
    document = _document(f"errors/{language}")
    return {int(code): said["headline"] for codes, said in document.items() for code in codes.split()}


def _document(name: str) -> Any:
    content = (files("doormill_ros.operator") / f"browser/texts/{name}.json").read_text(encoding="utf-8")
    return json.loads(content)
