"""The page's figures in the docs are those of the code."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from doormill_ros.operator.access import short_body, tries
from doormill_ros.operator.access.token import Role
from doormill_ros.operator.orders import audit

TEXT = (Path(__file__).parents[2] / "docs" / "operators-page.md").read_text()
NUMBERS = {1: "one", 5: "five", 9: "nine"}


def test_limits_and_files_are_told_as_they_are() -> None:
    for words in (
        f"after {NUMBERS[tries.FREE]} wrong tokens",
        f"at most {tries.LONGEST_WAIT:.0f} s",
        f"forgotten {tries.FORGOTTEN:.0f} s after",
        f"more than {short_body.LARGEST_BODY} bytes",
        f"beyond {audit.LARGEST} bytes",
        f"{NUMBERS[audit.KEPT]} of either kind",
        f"`{audit.ORDERS}`: with one",
        f"`{audit.REFUSED}`: with none",
        *(f"| {role.word} |" for role in Role),
        *(f"`{field.name}`" for field in fields(audit.AuditEntry)),
    ):
        assert words in TEXT
