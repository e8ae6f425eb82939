"""What an operator reads of errors, states and nodes: each has its words in every language, and the page shows them."""

from __future__ import annotations

import json
import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.graph.node_names import DOOR_SHARES
from doormill_ros.cell.graph.readiness import BESIDE, CONTROLLER, NEEDED
from doormill_ros.errors import catalogue
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.operator.languages import LANGUAGES, headline_in
from doormill_ros.operator.views.captioned_picture import CAPTIONS
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.situation import MAY_MOVE, situation
from doormill_ros.operator.views.state import CellView
from doormill_ros.pages.picture import MEDIA_TYPE, encode_picture
from support.browser import open_page
from support.waiting import LIMIT

ROOT = Path(__file__).parents[2]
FOLDER = Path(str(files("doormill_ros.operator"))) / "browser" / "texts"
TEXTS: dict[str, dict[str, str]] = {
    code: json.loads((FOLDER / f"{code}.json").read_text()) for code in LANGUAGES
}
#: Headline and advice by the codes that they belong to, with blanks between them.
ERRORS: dict[str, dict[str, dict[str, str]]] = {
    code: json.loads((FOLDER / "errors" / f"{code}.json").read_text()) for code in LANGUAGES
}
REGISTER = {error.code for error in catalogue()}
LONGEST = {"headline": 70, "advice": 140}  # characters; a headline on a tablet is one line
REASON = "door oak: no edge was found within 12.5 mm of x = 1.874 m; clean the lens & check the lamp"
FAULT = "the camera did not answer within 3 s; check its cable"
BUSY = "door elm was not started: oak is being milled; wait until it is done"
TRANSLATED = [code for code in LANGUAGES if code != "en"]
#: What is shown and not marked as English.
UNMARKED = """() => {
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found = [];
  while (walk.nextNode()) {
    const element = walk.currentNode.parentElement;
    if (element.checkVisibility() && element.closest("[lang]").lang !== "en") found.push(walk.currentNode.textContent);
  }
  return found.join("|");
}"""


def without_text(texts: dict[str, dict[str, str]], codes: set[int]) -> list[int]:
    told = {int(code) for codes in texts for code in codes.split()}
    return sorted(codes - told)


def said_of(language: str, code: int) -> dict[str, str]:
    return next(said for codes, said in ERRORS[language].items() if str(code) in codes.split())


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_code_of_the_register_has_one_text(language: str) -> None:
    texts = ERRORS[language]
    assert without_text(texts, REGISTER) == []
    assert without_text(texts, REGISTER | {9999}) == [9999]
    told = [int(code) for codes in texts for code in codes.split()]
    assert len(told) == len(set(told)), "a code with two texts"
    assert set(told) == REGISTER, "a text of a code that is given no more"


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_texts_of_errors_are_whole_short_and_of_their_language(language: str) -> None:
    texts, english = ERRORS[language], ERRORS["en"]
    assert list(texts) == list(english)
    for codes, said in texts.items():
        assert set(said) == set(LONGEST), codes
        assert all(said[part].strip() and len(said[part]) <= LONGEST[part] for part in LONGEST), codes
        assert said["headline"][-1] not in ".:;", codes
        assert said["advice"].endswith("."), codes
        assert not re.search(r"[{}<>]", "".join(said.values())), codes
        if language != "en":
            assert all(said[part] != english[codes][part] for part in LONGEST), f"{codes} was copied"
    headlines = [said["headline"] for said in texts.values()]
    assert len(set(headlines)) == len(headlines)


@pytest.mark.parametrize("language", LANGUAGES)
def test_states_stages_and_nodes_have_their_words(language: str) -> None:
    texts = TEXTS[language]
    action = (ROOT / "doormill_interfaces" / "action" / "MillDoor.action").read_text()
    stages = re.search(r"^string stage +# (.*)$", action, re.M)[1].split(", ")
    assert len(stages) == 6
    nodes = {*NEEDED, *BESIDE, *CELL_SENSORS, CONTROLLER, DOOR_SHARES}
    wanted = {f"situation.{state.value}" for state in HandshakeState}
    wanted |= {f"stage.{stage}" for stage in stages} | {f"node.{node}" for node in nodes}
    assert wanted <= set(texts)
    assert {key.removeprefix("caption.") for key in texts if key.startswith("caption.")} == set(CAPTIONS)


def test_what_follows_for_a_waiting_door_says_the_same_in_english() -> None:
    texts, seen = TEXTS["en"], set()
    for state in ("done", "failed"):
        for before in ("", "oak"):
            for run, request in (("r2", True), ("r2", False), ("", False)):
                found = situation(state, "why", ("r1", before), (run, "elm" if run else ""), "r2", request)
                if found.told:
                    continue
                seen.add(found.key)
                name = texts["before.name"].format(door=found.before) if found.before else ""
                ended = texts[f"before.{found.ended}"].format(name=name)
                assert texts[f"situation.{found.key}"].format(door=found.door, before=ended) == found.reason
    own = {f"situation.{key}" for key in (MAY_MOVE, *(state.value for state in HandshakeState))}
    assert {f"situation.{key}" for key in seen} == {k for k in texts if k.startswith("situation.")} - own


def test_captions_say_the_same_in_english() -> None:
    assert {key: TEXTS["en"][f"caption.{key}"] for key in CAPTIONS} == CAPTIONS


def test_the_state_of_the_page_gives_the_codes() -> None:
    view = CellView().with_handshake("failed", "the file was refused", "r0", "oak", error_code=488)
    view = view.with_run("r1", "oak").with_refused_picture("r1", REASON, 201)
    assert (view.document()["refusal_code"], view.document()["state_code"]) == (201, 0)  # of another door
    view = view.with_ended(EndedRun("r1", "oak", False, 203, REASON, 1.0)).with_notice(BUSY, 802)
    document = view.with_fault("gige_camera", FAULT, 242).with_fault("elsewhere", "odd").document()
    codes = [document[name] for name in ("refusal_code", "state_code", "notice_code")]
    assert codes == [203, 0, 802]  # the state of before was of another door
    assert [(fault["node"], fault["error_code"]) for fault in document["faults"]] == [
        ("elsewhere", 0),
        ("gige_camera", 242),
    ]
    assert view.with_ended(EndedRun("r2", "oak", True, 0, "milled", 2.0)).document()["refusal_code"] == 0


def is_english(page: Page, selector: str, words: str) -> None:
    expect(page.locator(selector)).to_have_text(words)
    expect(page.locator(selector)).to_have_attribute("lang", "en")


def refuse(store: Any) -> None:
    picture = encode_picture(np.zeros((8, 8), np.uint8))
    values = {"door": "oak"}
    store.update(
        lambda v: (
            v.with_handshake("failed", "it came to nothing", "r1", "oak", error_code=487)
            .with_ended(EndedRun("r1", "oak", False, 201, REASON, 1.0))
            .with_notice(BUSY, 802)
            .with_picture(picture, MEDIA_TYPE, CAPTIONS["refused"].format(**values), "refused", values)
        )
    )


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_refused_door_is_told_in_the_readers_language(read_only: Any, language: str) -> None:
    refuse(read_only.store)
    said = said_of(language, 201)
    assert headline_in(language, 201) == said["headline"]
    with open_page(read_only.url, locale=language) as (page, errors):
        expect(page.locator("html")).to_have_attribute("lang", language)
        expect(page.locator("#refusal-headline")).to_have_text(said["headline"])
        expect(page.locator("#refusal-advice")).to_have_text(said["advice"])
        is_english(page, "#refusal-words", REASON)
        expect(page.locator("#notice-headline")).to_have_text(said_of(language, 802)["headline"])
        expect(page.locator("#notice-advice")).to_have_text(said_of(language, 802)["advice"])
        is_english(page, "#notice-words", BUSY)
        expect(page.locator("#caption")).to_have_text(TEXTS[language]["caption.refused"].format(door="oak"))
        row = page.locator("#history tr:first-child td:last-child p")
        expect(row).to_have_text([said["headline"], REASON])
        expect(row.nth(1)).to_have_attribute("lang", "en")
        if language != "en":
            state, why = TEXTS[language]["situation.failed"], said_of(language, 487)["headline"]
            expect(page.locator("#state")).to_have_text(f"{state}: {why}")
            is_english(page, "#state-words", "failed: it came to nothing")
        else:
            expect(page.locator("#state")).to_have_text("failed: it came to nothing")
        assert errors == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_nothing_but_reports_is_english(read_only: Any, language: str) -> None:
    """Every English sentence of a text file and of a node, looked for in what is not marked as English."""
    refuse(read_only.store)
    faulty = {
        "gige_camera": (FAULT, 242),
        "cell1/abb_bridge/controller": ("guard stop", 478),
        "odd": ("odd!", 0),
    }
    for node, (message, code) in faulty.items():
        read_only.store.update(lambda v, n=node, m=message, c=code: v.with_fault(n, m, c))
    english = {text for text in TEXTS["en"].values() if len(text) > 12 and "{" not in text}
    english |= {text for said in ERRORS["en"].values() for text in said.values()}
    english |= {REASON, BUSY, FAULT, "guard stop", "odd!", "it came to nothing", "Refused picture"}
    with open_page(read_only.url, locale=language) as (page, errors):
        items = page.locator("#faults li")
        expect(items).to_have_count(3)
        controller, camera, odd = (said_of(language, code) for code in (478, 242, 1))
        for place, (said, own) in enumerate(
            [
                (controller, "cell1/abb_bridge/controller: guard stop"),
                (camera, f"gige_camera: {FAULT}"),
                (odd, "odd: odd!"),
            ]
        ):
            item = items.nth(place)
            expect(item.locator("strong")).to_contain_text(said["headline"])
            expect(item.locator("p").nth(0)).to_have_text(said["advice"])
            expect(item.locator("[lang=en]")).to_have_text(own)
        name = TEXTS[language]["node.abb_bridge/controller"]
        expect(items.nth(0)).to_contain_text(f"{name} (cell1/abb_bridge/controller): ")
        expect(page.locator("#next-step")).to_contain_text(name)
        expect(page.locator("#next-step")).to_contain_text(controller["headline"])
        shown = page.evaluate(UNMARKED)
        assert camera["advice"] in shown
        assert [text for text in english if text in shown] == []
        page.locator("#language").select_option("en")
        expect(page.locator("#next-step")).to_contain_text(
            "Put right what cell1/abb_bridge/controller reports"
        )
        expect(page.locator("#next-step")).to_contain_text("guard stop")
        assert errors == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_a_waiting_door_is_told_in_the_readers_language(read_only: Any, language: str) -> None:
    texts, update = TEXTS[language], read_only.store.update
    update(lambda v: v.with_handshake("done", "it was milled", "r1", "oak").with_run("r2", "elm"))
    update(lambda v: v.with_stage("pose", 0.3))
    name = texts["before.name"].format(door="oak")
    before = texts["before.done"].format(name=name)
    with open_page(read_only.url, locale=language) as (page, errors):
        waits = texts["situation.waits"].format(door="elm", before=before)
        expect(page.locator("#state")).to_have_text(waits)
        expect(page.locator("#state-words")).to_have_attribute("lang", "en")
        stage = texts["door.stage"].format(door="elm", stage=texts["stage.pose"])
        expect(page.locator("#door")).to_have_text(stage)
        # The link is cleared before the run, and again once the robot may move.
        states = [(state.value, state.value) for state in HandshakeState]
        for state, key in (*states, ("milling", "milling"), ("clearing", MAY_MOVE)):
            run_id = "" if key == "clearing" else "r2"
            update(lambda v, s=state, r=run_id: v.with_handshake(s, "in its own words", r, "elm"))
            expect(page.locator("#state-words")).to_have_text(f"{state}: in its own words")
            expect(page.locator("#state")).to_have_text(texts[f"situation.{key}"])
        update(lambda v: v.with_handshake("of a later release", "new", "r2", "elm"))
        expect(page.locator("#state")).to_have_text("of a later release")
        assert errors == []


@pytest.mark.parametrize("language", TRANSLATED)
def test_a_refused_order_is_answered_in_the_readers_language(controlled: Any, language: str) -> None:
    with open_page(controlled.url, locale=language) as (page, _):
        page.locator("#token").fill(controlled.token)
        page.locator("#wanted").fill("busy")
        page.locator("#mill").click()
        said = said_of(language, 802)
        expect(page.locator("#answer")).to_contain_text(f"{said['headline']}. {said['advice']}")
        is_english(page, "#answer [lang=en]", "(another door is being milled)")
    assert controlled.control.orders == []


def test_a_headline_is_found_in_the_history(read_only: Any) -> None:
    refuse(read_only.store)
    word = said_of("nb", 201)["headline"].split()[1]
    assert word not in REASON
    for language, count in (("nb", 1), ("de", 0)):
        query = {"search": word, "language": language}
        assert httpx.get(f"{read_only.url}history", params=query, timeout=LIMIT).json()["found"] == count
