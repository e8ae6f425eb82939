"""The languages of the page, and what a run came to in each of them."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Literal, get_args

from doormill_ros.operator.state import EndedRun

#: Of the page's texts; what the cell's nodes say in their own words is English.
Language = Literal["en", "de", "nb"]
LANGUAGES: tuple[Language, ...] = get_args(Language)


def outcome_in(language: Language, run: EndedRun) -> str:
    """What the page calls the outcome of a run in one of `LANGUAGES`."""
    return _texts(language)[f"outcome.{run.came_to}"].replace("{code}", str(run.error_code))


@cache
def _texts(language: Language) -> dict[str, str]:
    content = (files("doormill_ros.operator") / f"texts/{language}.json").read_text(encoding="utf-8")
    texts: dict[str, str] = json.loads(content)
    return texts
