"""What a bench prints goes to its own place in a page, and nothing else in it changes."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.page_part import put

PAGE = """# Page

<!-- begin: bench/one.py -->
| old | 1 |
<!-- end -->

Between them 2.

<!-- begin: bench/two.py errors -->

<!-- end -->
<!-- begin: bench/two.py causes -->
<!-- end -->
"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    path = tmp_path / "page.md"
    path.write_text(PAGE)
    return path


def test_each_part_is_put_into_its_place(page: Path) -> None:
    assert put(page, "bench/one.py", "| new | 3 |")
    assert put(page, "bench/two.py errors", "4 um")
    assert put(page, "bench/two.py causes", "one\n\ntwo")
    wanted = PAGE.replace("| old | 1 |", "| new | 3 |").replace("errors -->\n\n", "errors -->\n4 um\n")
    assert page.read_text() == wanted.replace("causes -->\n", "causes -->\none\n\ntwo\n")
    assert put(page, "bench/two.py errors", "5 um")
    assert page.read_text().count("um") == 1


@pytest.mark.parametrize("place", ["bench/two.py", "bench/three.py", "bench/one.py errors"])
def test_a_page_without_the_place_stays_as_it_is(page: Path, place: str) -> None:
    assert not put(page, place, "6 um")
    assert page.read_text() == PAGE
