"""The stack that all pages are made of: nothing is trusted, nothing is kept, and every chart is drawn in full."""

from __future__ import annotations

import re

import matplotlib
import numpy as np
import pytest

from doormill_ros.pages.charts import (
    BLUE,
    RED,
    BarRow,
    Curve,
    bars,
    png_figure,
    save_png,
    scatter,
    sheet,
    styled,
    svg,
)
from doormill_ros.pages.page import (
    Bar,
    Charts,
    Facts,
    Listing,
    Page,
    PageSection,
    Paragraphs,
    Picture,
    Table,
    Tiles,
    render,
)
from support.browser import open_page
from support.source_tree import SOURCES

WICKED = "<script>console.error('in')</script> & $x$"
OVERFLOWS = """() => [...document.querySelectorAll('svg text')].filter(t => {
    const a = t.getBoundingClientRect(), b = t.ownerSVGElement.getBoundingClientRect();
    return a.left < b.left - 0.5 || a.right > b.right + 0.5 || a.top < b.top - 0.5 || a.bottom > b.bottom + 0.5;
}).map(t => t.textContent)"""


def points(n: int) -> np.ndarray:
    return np.random.default_rng(1).normal(size=n)


def some_charts() -> list[str]:
    rows = [
        BarRow(WICKED, [36.2, 7.9], [RED, BLUE]),
        BarRow("a label that is much too long to stand", [3.0], [RED]),
    ]
    return [
        scatter(WICKED, "x [m]", "y [m]", [Curve(WICKED, RED, points(30), points(30))], band=1.0),
        scatter("square", "x [m]", "y [m]", lines=[Curve("", BLUE, points(9), 1e4 * points(9))], square=True),
        scatter("nothing", "x [m]", "y [m]", limits=(-1.0, 1.0)),
        bars("two a row", "um", rows, ("noise", 8.0)),
        bars("one a row", "um", [BarRow("alone", [0.0], [RED])]),
    ]


def a_page() -> Page:
    blocks = [
        Paragraphs([WICKED], note=True),
        Tiles([(WICKED, WICKED)]),
        Table(("a", WICKED), [[WICKED, Bar(WICKED, 0.5, RED)], ["c", "d"]], marked=1, name="models"),
        Table(("a", "b"), []),
        Facts([(WICKED, WICKED)], numbers=True),
        Listing(WICKED),
        Picture("data:,", WICKED),
        Charts(some_charts()),
    ]
    return Page(WICKED, [PageSection(WICKED, blocks)], lead=WICKED, good=False)


def test_texts_stay_text_and_charts_keep_them_inside(tmp_path) -> None:
    path = tmp_path / "page.html"
    path.write_text(render(a_page()), encoding="utf-8")
    with open_page(path.as_uri(), viewport={"width": 1280, "height": 900}) as (page, errors):
        assert page.inner_text("#verdict") == page.title() == WICKED
        assert page.locator("script").count() == 0
        texts = page.locator("svg text").all_text_contents()
        assert WICKED in texts
        assert "36.2 → 7.9 um" in texts
        assert page.evaluate(OVERFLOWS) == []
        drawn = page.locator("svg").evaluate_all("all => all.map(s => s.getBoundingClientRect().height)")
        assert len(drawn) == 5
        assert min(drawn) > 60
        assert page.locator("table.models tr").nth(2).get_attribute("class") == "own"
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert errors == []


def test_a_page_without_remarks_has_neither_lead_nor_colour() -> None:
    text = render(Page("It is so", []))
    assert "<h1>It is so</h1>" in text
    assert 'class="lead"' not in text


def test_a_chart_is_the_same_whenever_it_is_drawn_and_leaves_nothing_behind() -> None:
    before = dict(matplotlib.rcParams)
    assert some_charts() == some_charts()
    assert dict(matplotlib.rcParams) == before


def test_charts_refer_to_nothing_and_so_share_no_name() -> None:
    charts = some_charts()
    assert len(charts) > 1
    assert not re.search(r"\bid=|href=|url\(|http", "".join(charts))


def test_many_dots_become_a_picture() -> None:
    few, many = (scatter("", "", "", [Curve("", RED, points(n), points(n))]) for n in (100, 5000))
    assert "<image" not in few
    assert "<image" in many
    assert len(many) < 1e5


def test_settings_hold_where_a_chart_is_drawn() -> None:
    @styled
    def chart() -> str:
        figure = sheet(100, 200)
        figure.add_subplot().set_title("$left")
        return svg(figure, "words & more")

    assert ">$left</text>" in chart()
    assert 'aria-label="words &amp; more"' in chart()


def test_a_png_is_as_large_as_asked_for(tmp_path) -> None:
    save_png(png_figure(2.0, 1.0), tmp_path / "figure.png")
    data = (tmp_path / "figure.png").read_bytes()
    assert (int.from_bytes(data[16:20]), int.from_bytes(data[20:24])) == (220, 110)
    with pytest.raises(OSError, match="nowhere"):
        save_png(png_figure(2.0, 1.0), tmp_path / "nowhere" / "figure.png")


def test_nobody_draws_through_global_state() -> None:
    drawing = [text for path in SOURCES if "matplotlib" in (text := path.read_text(encoding="utf-8"))]
    assert len(drawing) >= 3
    assert not any("pyplot" in text or "matplotlib.use(" in text for text in drawing)
