"""What bags of runs say alone, on the page: in the reader's language, and in English as the monitor says it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from doormill_ros.monitor.cell_change import CellChange, ChangeSize
from doormill_ros.monitor.runs_finding import RunsFinding, few_runs, runs_finding
from doormill_ros.operator.views.runs_view import RunsView
from doormill_ros.operator.views.short_text import LONGEST_TEXT
from support.browser import open_page

PHONE = {"viewport": {"width": 360, "height": 640}, "has_touch": True}
NASTY = "<script>document.title='broken'</script>"


def step(cause: str, where: str, run: str, after: dict[str, Any], latest: str = "") -> dict[str, Any]:
    between = [run, latest or run]
    return {
        "what": cause,
        "where": where,
        "kind": "step",
        "from_run": run,
        "from_run_ci95": between,
        "after": after,
    }


def document(verdict: str, changes: list[dict[str, Any]], runs: int = 24, left: int = 0) -> dict[str, Any]:
    units = {"offset": "m, m, rad", "offset_y": "m", "moved_y": "m", "offset_rotation": "rad", "factor": "1"}
    tied = {"clamp_shift": [{"cause": "camera_shift"}, {"cause": "sensor_shift"}]}
    return {
        "verdict": verdict,
        "causes": [
            {
                "cause": one["what"],
                "where": one["where"],
                "parameters": {
                    name: {"value": value, "unit": units[name]} for name, value in one["after"].items()
                },
                "tied_with": tied.get(one["what"], []),
            }
            for one in changes
        ],
        "changes": changes,
        "runs": [{"run_id": f"r{number}"} for number in range(runs)],
        "left_aside": [{"bag": f"/bags/{number}", "why": "cannot be read"} for number in range(left)],
        "remarks": [],
    }


CAMERA = step("camera_shift", "camera", "r7", {"offset_y": 4.2e-4, "moved_y": -4.1e-4})
CLAMP = step("clamp_shift", "clamp", "r9", {"offset": [-1.2e-3, 2e-4, -5.3e-4]}, "r11")
DRIFT = {**step("controller_speed", "controller", "r0", {"factor": 1.213}), "kind": "drift"}
LINK = step("link_delay", "link", "r5", {"factor": 3.0})
PROBE = step("sensor_shift", "touch_probe", "r5", {"offset_rotation": 2e-4})
FOUND = {
    "consistent": runs_finding(document("consistent", [])),
    "unexplained": runs_finding(document("unexplained", [], 1)),
    "explained": runs_finding(document("explained", [CAMERA, CLAMP, LINK, PROBE], left=2)),
    "partly": runs_finding(document("partly_explained", [DRIFT])),
    "few": few_runs(1),
}
SAID = {
    "consistent": "24 runs by bags alone: nothing changed",
    "unexplained": "1 run by bags alone: something differs, and no known change explains it",
    "explained": "24 runs by bags alone: camera shift at camera (y +0.42 mm) from run r7 on and clamp shift at "
    "clamp (y -1.20 mm, z +0.20 mm, rotation -0.53 mrad) from run r9 on (95 %: r9 to r11), which the bags cannot tell "
    "from camera shift or sensor shift and link delay at link (3.00 times) from run r5 on and sensor shift at "
    "touch_probe (rotation +0.20 mrad) from run r5 on; once that is put right, name the first run after it in since of "
    "/model_monitor; bags left aside: 2",
    "partly": "24 runs by bags alone: controller speed at controller (1.21 times) that drifts from run r0 on, and "
    "something without a name; once that is put right, name the first run after it in since of /model_monitor",
    "few": "1 run by bags alone: changes are told from 6 on",
}


def view_of(found: RunsFinding) -> RunsView:
    return RunsView(
        found.sentence,
        found.verdict,
        found.changes,
        found.questioned,
        found.next_measurement,
        found.left_aside,
    )


def said(page: Page, function: str, view: RunsView) -> str:
    """What a function of the page makes of a verdict, in the language that the page speaks."""
    script = "([name, found]) => import('/runs_words.js').then((words) => words[name](found))"
    return str(page.evaluate(script, [function, view.document()]))


@pytest.mark.parametrize("kind", FOUND)
def test_the_monitor_says_what_changed_where_since_when_and_how_much(kind: str) -> None:
    assert FOUND[kind].sentence == SAID[kind]


def test_the_data_of_a_verdict_say_all_that_the_monitor_says(read_only: Any) -> None:
    with open_page(read_only.url) as (page, errors):
        expect(page.locator("#state")).to_have_text("unknown")
        assert len(FOUND) == 5
        for found in FOUND.values():
            assert said(page, "runsSentence", view_of(found)) == found.sentence
            assert said(page, "runsNext", view_of(found)) == found.next_measurement
        assert errors == []


@pytest.mark.parametrize(
    ("locale", "heading", "words"),
    [
        (
            "de-AT",
            "Zelle nach den Aufzeichnungen ihrer Läufe allein",
            (
                "Kameraverschiebung an der Kamera (y +0,42 mm) ab Lauf r7",
                "in der Verbindung zur Steuerung (3,00-fach)",
            ),
        ),
        (
            "nb-NO",
            "Cellen etter opptakene av kjøringene alene",
            ("kameraforskyvning ved kameraet (y +0,42 mm) fra kjøring r7", "(95 %: r9 til r11)"),
        ),
        ("fr-FR", "Cell by the bags of its runs alone", (SAID["explained"],)),
    ],
)
def test_the_page_shows_it_in_the_readers_language(
    read_only: Any, locale: str, heading: str, words: tuple[str, ...]
) -> None:
    read_only.store.update(lambda view: view.with_runs(view_of(FOUND["explained"])))
    with open_page(read_only.url, locale=locale, **PHONE) as (page, errors):
        expect(page.locator("#runs h2")).to_have_text(heading)
        expect(page.locator("#runs-verdict")).to_contain_text(words[0])
        shown = page.locator("#runs-verdict").inner_text()
        assert [word for word in words if word not in shown] == []
        expect(page.locator("#runs-next")).to_contain_text("r7")
        # Which bags they are stands in the monitor's words.
        expect(page.locator("#runs-left li")).to_have_count(2)
        expect(page.locator("#runs-left")).to_have_attribute("lang", "en")
        assert page.locator("#runs-hint").is_visible() == (locale != "fr-FR")
        assert page.evaluate("document.documentElement.scrollWidth") <= 360
        assert errors == []


def test_it_has_a_place_of_its_own_only_where_something_is_said(read_only: Any) -> None:
    with open_page(read_only.url) as (page, errors):
        expect(page.locator("#state")).to_have_text("unknown")
        assert not page.locator("#runs").is_visible()
        read_only.store.update(lambda view: view.with_runs(RunsView(asking=True)))
        read_only.store.update(lambda view: view.with_runs(view_of(FOUND["consistent"])))
        expect(page.locator("#runs-verdict")).to_have_text(SAID["consistent"])
        expect(page.locator("#runs-next")).to_be_hidden()
        assert not page.locator("#model").is_visible()
        wrong = replace(view_of(FOUND["consistent"]), error_code=844, message="no space left")
        read_only.store.update(lambda view: view.with_runs(wrong))
        expect(page.locator("#runs-message")).to_have_text("no space left")
        assert errors == []


@pytest.mark.parametrize("locale", ["en-GB", "de-DE"])
def test_no_word_of_it_becomes_markup(read_only: Any, locale: str) -> None:
    change = CellChange(NASTY, NASTY, "step", NASTY, NASTY, NASTY, (ChangeSize(NASTY, 1.0, NASTY),), (NASTY,))
    nasty = RunsView(NASTY, "explained", (change,), 6, NASTY, (NASTY,), False, 844, NASTY)
    read_only.store.update(lambda view: view.with_runs(nasty))
    with open_page(read_only.url, locale=locale) as (page, errors):
        expect(page.locator("#runs-verdict")).to_contain_text(NASTY)
        expect(page.locator("#runs-left")).to_contain_text(NASTY)
        assert page.locator("script").count() == 1
        assert page.title() not in ("", "broken")
        assert errors == []


def test_words_longer_than_the_page_shows_are_cut() -> None:
    long = "x" * (2 * LONGEST_TEXT)
    cut = RunsView(long, "explained", (), 6, long, (long,), False, 844, long).shortened()
    texts = (cut.sentence, cut.next_measurement, *cut.left_aside, cut.message)
    assert [len(text) for text in texts] == [LONGEST_TEXT] * 4
