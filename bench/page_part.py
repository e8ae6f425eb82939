"""Put what a bench printed into its place in a page: from `<!-- begin: bench/NAME.py PART -->` to `<!-- end -->`."""

from __future__ import annotations

from pathlib import Path

END = "<!-- end -->"


def put(page: Path, place: str, text: str) -> bool:
    """Replace what stands at a place of a page; False, and nothing is changed, where the page has no such place.

    Args:
        page: A page in Markdown.
        place: The bench, and the part where it prints several: `bench/NAME.py` or `bench/NAME.py PART`.
        text: What is to stand there.
    """
    begin = f"<!-- begin: {place} -->\n"
    head, found, rest = page.read_text(encoding="utf-8").partition(begin)
    _, ended, tail = rest.partition(END)
    if not (found and ended):
        return False
    page.write_text(f"{head}{begin}{text}\n{END}{tail}", encoding="utf-8")
    return True
