"""Write the table of error codes: docs/errors.md and the short one of README.md."""

from __future__ import annotations

import re
from pathlib import Path

from doormill_ros.errors import RANGES, ErrorCode, catalogue

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "errors.md"
README = ROOT / "README.md"
SHORT_TABLE = re.compile(r"\| codes \| from \| for example \|\n(?:\|.*\n)+")


def page(codes: list[ErrorCode]) -> str:
    """All codes with class, room and sentence; the text of docs/errors.md."""
    rows = [f"| {c.code} | `{c.name}` | {c.room or '.'} | {c.sentence} |" for c in codes]
    head = [
        "# Error codes",
        "",
        "Messages and action results carry the code; 0 is success. The room is the folder of `doormill_ros/` whose",
        "`errors` module holds the class. Written by `python -m scripts.list_errors` from the classes.",
        "",
        "| code | class | room | what is wrong |",
        "| --- | --- | --- | --- |",
    ]
    return "\n".join([*head, *rows]) + "\n"


def short_table(codes: list[ErrorCode]) -> str:
    """One row for each hundred of codes with examples, as README.md shows it."""
    by_code = {c.code: c for c in codes}
    rows = [
        f"| {first}..{first + 99} | {about} | "
        + "; ".join(f"{code} {by_code[code].sentence.rstrip('.')}" for code in examples)
        + " |"
        for first, about, examples in RANGES
    ]
    return "\n".join(["| codes | from | for example |", "| --- | --- | --- |", *rows]) + "\n"


def readme_table(text: str) -> str:
    """The short table as it stands in the text of README.md; empty if there is none."""
    match = SHORT_TABLE.search(text)
    return match.group() if match else ""


def main() -> None:
    """Write both files anew."""
    codes = catalogue()
    PAGE.write_text(page(codes), encoding="utf-8")
    text = README.read_text(encoding="utf-8")
    README.write_text(text.replace(readme_table(text), short_table(codes)), encoding="utf-8")


if __name__ == "__main__":
    main()
