"""The thesis' RAPID listings, set from the tokens in test/data/thesis/rapid_listings.yaml."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from support.source_tree import DATA


@dataclass(frozen=True)
class Repair:
    """What is wrong in the print of a figure.

    Attributes:
        figure: Its number.
        printed: What stands there.
        meant: What the listings here hold instead.
        why: What happened.
    """

    figure: str
    printed: str
    meant: str
    why: str


def load_listings() -> tuple[dict[str, str], list[Repair]]:
    """RAPID text by figure number, repaired, and what was repaired."""
    document = yaml.safe_load((DATA / "thesis" / "rapid_listings.yaml").read_text(encoding="utf-8"))
    return (
        {number: _figure(**entry) for number, entry in document["figures"].items()},
        [Repair(**entry) for entry in document["repairs"]],
    )


def _figure(statements: list[list[Any]], procedure: str = "") -> str:
    lines = "".join(f"{_statement(tokens)};\n" for tokens in statements)
    return f"PROC {procedure}()\n{lines}ENDPROC\n" if procedure else lines


def _statement(tokens: list[Any]) -> str:
    first, *rest = tokens
    if first == ":=":
        return f"{rest[0]} := {_value(rest[1])}"
    if first == "VAR":
        return " ".join(tokens)
    return f"{first} {_arguments(rest)}".rstrip()


def _value(token: Any) -> str:
    """A token as it is; a list is a call."""
    return f"{token[0]}({_arguments(token[1:])})" if isinstance(token, list) else str(token)


def _arguments(tokens: list[Any]) -> str:
    """Separated by commas, but for optional arguments."""
    text = ",".join(map(_value, tokens))
    return text.replace(",\\", "\\")
