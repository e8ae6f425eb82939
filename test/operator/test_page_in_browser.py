"""The page in a real browser: it follows the cell, escapes what it shows and gives orders."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from doormill_ros.diagnosis.parts.telling.next_step import NextStep
from doormill_ros.monitor.finding import NamedFault
from doormill_ros.operator.views.door_view import DoorView, FeatureView
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.model_view import ModelView, TrendDoor
from doormill_ros.pages.picture import MEDIA_TYPE, encode_picture
from support.browser import TABLET, open_page

REASON = "door oak: no edge was found in the picture; clean the lens & check the lamp"
NASTY = "<img src=x onerror=\"document.title='broken'\"><script>document.title='broken'</script>&amp;"


def text_of(page: Page, selector: str, text: str) -> None:
    expect(page.locator(selector)).to_contain_text(text)


def test_a_refusals_reason_shows_up_by_itself(shown: tuple[Any, Page, list[str]]) -> None:
    served, page, errors = shown
    update = served.store.update
    update(lambda v: v.with_handshake("requested", "the controller asks"))
    text_of(page, "#state", "requested: the controller asks")
    update(lambda v: v.with_run("r1", "oak").with_stage("picture", 0.1))
    text_of(page, "#door", "oak, stage picture")
    expect(page.locator("#refusal")).to_be_hidden()
    update(lambda v: v.with_ended(EndedRun("r1", "oak", False, 201, REASON, 1.0)))
    text_of(page, "#refusal", REASON)
    expect(page.locator("#refusal")).to_be_visible()
    text_of(page, "#last", "oak, refused (201)")
    text_of(page, "#history tr:first-child", REASON)
    text_of(page, "#next-step", "not milled")
    colour = "getComputedStyle(document.getElementById('step')).backgroundColor"
    refused = page.evaluate(colour)
    update(lambda v: v.with_run("r2", "oak").with_ended(EndedRun("r2", "oak", True, 0, "milled well", 2.0)))
    text_of(page, "#history tr:first-child", "milled well")
    expect(page.locator("#refusal")).to_be_hidden()
    assert page.evaluate(colour) != refused
    assert page.locator("#history tr").count() == 2
    assert errors == []


def test_the_picture_is_shown_and_replaced(shown: tuple[Any, Page, list[str]]) -> None:
    served, page, errors = shown
    for width in (64, 96):
        data = encode_picture(np.full((48, width), 90, np.uint8))
        served.store.update(lambda v, d=data, w=width: v.with_picture(d, MEDIA_TYPE, f"{w} wide"))
        text_of(page, "#caption", f"{width} wide")
        expect(page.locator("#picture")).to_have_js_property("naturalWidth", width)
    assert errors == []


def test_no_text_becomes_markup(shown: tuple[Any, Page, list[str]]) -> None:
    served, page, errors = shown
    served.store.update(
        lambda v: (
            v.with_handshake("idle", NASTY)
            .with_ended(EndedRun("r1", NASTY, False, 1, NASTY, 1.0))
            .with_run("r2", NASTY)
            .with_stage(NASTY, 0.5)
            .with_refused_picture("r2", NASTY)
            .with_fault(NASTY, NASTY)
            .with_notice(NASTY)
            .with_picture(encode_picture(np.zeros((8, 8), np.uint8)), MEDIA_TYPE, NASTY)
        )
    )
    for selector in ("#state", "#door", "#last", "#refusal", "#faults", "#notice", "#caption", "#history"):
        text_of(page, selector, NASTY)
    nothing_became_markup(page)
    assert errors == []


def nasty_model() -> ModelView:
    """A verdict whose every word is hostile, in the monitor's own words and as the data of other languages."""
    return ModelView(
        sentence=NASTY,
        next_measurement=NASTY,
        remarks=(NASTY,),
        version=1,
        proposed=2,
        expected=3e-4,
        limit=5e-4,
        stopped=True,
        message=NASTY,
        doors=(TrendDoor(NASTY, NASTY, 0, 3e-4), TrendDoor("elm", "r2", 1, 7e-4)),
        verdict="explained",
        causes=(NamedFault(NASTY, NASTY, "step", NASTY, NASTY),),
        questioned=2,
        next_steps=(NextStep("points", NASTY, NASTY, "", 40, NASTY, NASTY),),
        error_code=840,
    )


def nasty_door() -> DoorView:
    corners = ((10.0, 10.0), (60.0, 10.0), (60.0, 90.0))
    features = tuple(FeatureView(NASTY, face, False, corners) for face in ("front", "lock_edge"))
    return DoorView("r1", NASTY, 800.0, 2000.0, 40.0, features)


def nothing_became_markup(page: Page) -> None:
    assert page.locator("img").count() == 1
    assert page.locator("script").count() == 1
    assert page.locator("[onerror]").count() == 0
    assert page.title() not in ("", "broken")


@pytest.mark.parametrize("language", ["en", "de", "nb"])
def test_no_word_of_a_door_or_a_verdict_becomes_markup(
    shown: tuple[Any, Page, list[str]], language: str
) -> None:
    """Door ids and feature names come from recipes and bags, sentences from whoever can publish them."""
    served, page, errors = shown
    page.locator("#language").select_option(language)
    served.store.update(
        lambda v: v.with_run("r1", NASTY).with_drawing(nasty_door()).with_model(nasty_model())
    )
    own = ("#model-message", "#remarks") if language == "en" else ("#model-words", "#remarks")
    for selector in ("#drawing-title", "#drawing-features", "#verdict", "#measure-next", *own):
        text_of(page, selector, NASTY)
    assert page.locator("#drawing polygon").count() == 2
    for title in page.locator("#drawing polygon title").all():
        assert NASTY in (title.text_content() or "")
    assert page.locator("#trend circle").count() == 2
    assert NASTY in (page.locator("#trend circle title").first.text_content() or "")
    nothing_became_markup(page)
    assert errors == []


@pytest.mark.parametrize("size", [(360, 640), (768, 1024), (1024, 768), (1920, 1080)])
def test_it_fits_the_screen_in_large_type(controlled: Any, size: tuple[int, int]) -> None:
    word = "w" * 120
    controlled.store.update(
        lambda v: v.with_handshake("idle", word).with_ended(EndedRun("r", word, False, 1, word, 1.0))
    )
    with open_page(controlled.url, viewport={"width": size[0], "height": size[1]}) as (page, errors):
        text_of(page, "#last", word)
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
        sizes = page.evaluate(
            "['next-step', 'state', 'history'].map("
            "id => parseFloat(getComputedStyle(document.getElementById(id)).fontSize))"
        )
        assert min(sizes) >= 17
        # What to do now is seen without a touch.
        box = page.locator("#next-step").bounding_box()
        assert box is not None
        assert box["y"] + box["height"] <= size[1]
        assert errors == []


def test_orders_need_the_token(controlled: Any) -> None:
    with open_page(controlled.url, **TABLET) as (page, errors):
        page.locator("#wanted").fill("oak")
        page.locator("#token").fill("wrong")
        page.locator("#mill").click()
        text_of(page, "#answer", "token is missing or wrong")
        assert controlled.control.orders == []
        errors.clear()  # the browser reports the 401
        page.locator("#token").fill(controlled.token)
        page.locator("#mill").click()
        text_of(page, "#answer", "door oak is started")
        page.locator("#cancel").click()
        text_of(page, "#answer", "canceled")
        assert controlled.control.orders == ["mill oak", "cancel"]
        assert controlled.token not in page.url
        assert controlled.token not in page.content()
        kept = page.evaluate("JSON.stringify([localStorage, sessionStorage, document.cookie])")
        assert controlled.token not in kept
        assert errors == []


@pytest.mark.parametrize("refused", [False, True])
def test_no_answer_becomes_markup(controlled: Any, refused: bool) -> None:
    with open_page(controlled.url, **TABLET) as (page, errors):
        page.locator("#token").fill(controlled.token)
        page.locator("#wanted").fill(f"{'silent' if refused else ''}{NASTY[:90]}")
        page.locator("#mill").click()
        text_of(page, "#answer", NASTY[:50])
        nothing_became_markup(page)
        assert (controlled.control.orders == []) is refused
        errors[:] = [] if refused else errors  # the browser reports the 409
        assert errors == []


def test_doors_of_the_database_are_offered(controlled: Any) -> None:
    with open_page(controlled.url, **TABLET) as (page, errors):
        offered = page.locator("#doors option")
        expect(page.locator("#wanted")).to_be_visible()  # what is hidden takes no focus
        page.locator("#wanted").focus()
        expect(offered).to_have_count(3)
        page.locator("#wanted").fill("oak_")
        expect(offered).to_have_count(1)
        assert offered.get_attribute("value") == "oak_2"
        assert page.title() == "Door milling cell"
        assert errors == []


def test_a_page_that_only_shows_offers_no_control(read_only: Any) -> None:
    with open_page(read_only.url, **TABLET) as (page, errors):
        text_of(page, "#state", "unknown")
        expect(page.locator("#control")).to_be_hidden()
        assert errors == []
