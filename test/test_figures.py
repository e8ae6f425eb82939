"""Figures of the pages are those of code and configuration, or of a bench's run that is kept with its commit."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from support.page_coverage import WRITTEN, cited, uncovered
from support.page_figures import RESULTS, Row, agrees, not_recorded, number_of, results, rows
from support.source_tree import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
ROWS = rows()
CITED = cited()
#: Pages of which every figure is held by a row, or listed as cited.
FINISHED = (
    "README.md",
    "docs/architecture.md",
    "docs/calibration.md",
    "docs/catalogue.md",
    "docs/commissioning.md",
    "docs/controller-link.md",
    "docs/diagnosis-thesis.md",
    "docs/diagnosis-ur10.md",
    "docs/diagnosis.md",
    "docs/errors.md",
    "docs/gige-camera.md",
    "docs/inspection.md",
    "docs/laws.md",
    "docs/living.md",
    "docs/localization.md",
    "docs/model-monitor.md",
    "docs/operators-page.md",
    "docs/rapid.md",
    "docs/recipes.md",
    "docs/recording.md",
    "docs/sensors.md",
    "docs/thesis.md",
    "docs/toolpath.md",
    "docs/two-robots.md",
    "docs/workspace.md",
    "docs/world.md",
)


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{Path(row.page).stem}: {row.words[:40]}")
def test_the_page_says_what_its_source_gives(row: Row) -> None:
    assert row.complaints(text_of(row.page)) == []


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{Path(row.page).stem}: {row.words[:40]}")
def test_another_figure_in_the_page_is_seen(row: Row) -> None:
    said = row.said(text_of(row.page))
    assert said is not None
    filled = row.words
    for figure in said:
        filled = filled.replace("{}", figure, 1)
    assert row.complaints(filled) == []
    for place in range(len(said)):
        wrong = ["7777" if other == place else figure for other, figure in enumerate(said)]
        text = row.words
        for figure in wrong:
            text = text.replace("{}", figure, 1)
        assert len(row.complaints(text)) == 1


def test_figures_agree_to_the_digits_that_are_printed() -> None:
    assert agrees("0.5", 0.549, 0.0)
    assert not agrees("0.50", 0.549, 0.0)
    assert agrees("12,000", 12000.4, 0.0)
    assert agrees("nine", 9.0, 0.0)
    assert not agrees("nine", 9.2, 0.0)
    assert agrees("9", 9.9, 0.1)
    assert not agrees("9", 11.0, 0.1)


def test_there_are_many() -> None:
    assert sum(len(row.sources) for row in ROWS) > 60
    assert len({row.page for row in ROWS}) >= 8


#: Kept runs that did not end well, and why they are kept.
BOUNDS_MISSED = {
    "bench_empty_clamp": "a jaw nearly as dark as what is behind it may show too little without a door",
    "bench_conditions": "four conditions are such that no single picture shows what is wrong; two poses beside",
    "bench_pairs": "what cannot be seen is counted, and narrow strips push an edge by more than is stated",
    "bench_views": "a rounded arris as dark as what is behind it moves the edge that is seen by a tenth of a mm",
    "random_shift_score": "after 43 of 50 loops, not all, at most 1.5 times what gauge and program leave remains",
    "runs_score": "one series without a change is called changed",
}


def lacking(path: Path) -> list[str]:
    """What a kept run does not say of itself, or that no page uses it."""
    head = path.read_text(encoding="utf-8").split("\n\n")[0]
    kept = f"bench/results/{path.name}#"
    said = {
        "command": rf"^command: python bench/{path.stem}\.py\b",
        "date": r"^date: \d{4}-\d\d-\d\d \d\d:\d\d UTC$",
        "commit": r"^commit: [0-9a-f]{40}\b",
    }
    status = "exit status: [1-9]" if path.stem in BOUNDS_MISSED else "exit status: 0"
    said[status] = rf"^{status}$"
    missing = [name for name, pattern in said.items() if not re.search(pattern, head, re.MULTILINE)]
    used = any(source.startswith(kept) for row in ROWS for source in row.sources)
    there = (ROOT / "bench" / f"{path.stem}.py").is_file()
    return missing + ([] if used else ["a page that uses it"]) + ([] if there else ["the bench"])


def test_kept_runs_say_how_they_came_about_and_are_used(tmp_path: Path) -> None:
    assert {path.name: lacking(path) for path in results()} == {path.name: [] for path in results()}
    (tmp_path / "no_bench.txt").write_text("date: yesterday\n")
    assert lacking(tmp_path / "no_bench.txt") == [
        "command",
        "date",
        "commit",
        "exit status: 0",
        "a page that uses it",
        "the bench",
    ]


def test_every_bench_that_a_page_names_is_kept_or_listed_as_missing() -> None:
    named = {
        name for page in PAGES for name in re.findall(r"\bbench/(\w+)\.py", page.read_text(encoding="utf-8"))
    }
    kept = {path.stem for path in results()}
    assert not_recorded().keys() == named - kept
    assert all(len(why) > 10 for why in not_recorded().values())


def test_sources_are_read() -> None:
    assert number_of("config/camera.yaml#localizer.max_age") == 2.0
    assert number_of("config/camera.yaml#localizer.max_deviation.0 * 1e6") == pytest.approx(30.0)
    assert number_of("doormill_ros.nodes.operator_page:OperatorPage#port") == 8080
    with pytest.raises(KeyError):
        number_of("config/camera.yaml#localizer.no_such_key")


@pytest.mark.parametrize("page", FINISHED)
def test_every_figure_of_a_finished_page_has_its_source(page: str) -> None:
    assert uncovered(page, text_of(page), ROWS, CITED.get(page, {})) == []


@pytest.mark.parametrize("page", FINISHED)
def test_a_new_figure_in_a_finished_page_is_seen(page: str) -> None:
    paragraphs = text_of(page).split("\n\n")
    for place in (1, len(paragraphs) // 2, len(paragraphs)):
        text = "\n\n".join([*paragraphs[:place], "It takes 4711.3 s.", *paragraphs[place:]])
        (said,) = uncovered(page, text, ROWS, CITED.get(page, {}))
        assert "It takes 4711.3 s." in said


@pytest.mark.parametrize(("page", "pattern"), [(page, pattern) for page in CITED for pattern in CITED[page]])
def test_what_is_cited_is_in_the_page_and_is_no_leave_for_any_figure(page: str, pattern: str) -> None:
    others = {other: why for other, why in CITED[page].items() if other != pattern}
    assert uncovered(page, text_of(page), ROWS, others) != []
    assert re.search(pattern, "It takes 4711.3 s, 0 or 1 or 2 | 12 | 0.5 mm (3).") is None
    assert len(CITED[page][pattern].split()) > 1


def test_what_a_bench_wrote_into_a_page_is_what_its_kept_run_printed() -> None:
    written = [part for page in PAGES for part in re.findall(WRITTEN, page.read_text(encoding="utf-8"))]
    assert {bench for bench, _, _ in written} == {"compare_sensors", "diagnosis_ur10", "ur10_floor"}
    for bench, _, text in written:
        assert text.strip()
        assert text in (RESULTS / f"{bench}.txt").read_text(encoding="utf-8")
    # Where the run prints its parts by name, each stands where its name is.
    printed = [part for path in results() for part in re.findall(WRITTEN, path.read_text(encoding="utf-8"))]
    named = [part for part in written if part[1]]
    assert len(named) > 5
    assert set(named) <= set(printed)


def test_only_finished_pages_cite() -> None:
    assert CITED.keys() <= set(FINISHED)
