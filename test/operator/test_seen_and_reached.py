"""The page can be read in the light and in the dark, and used without a mouse."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from doormill_ros.operator.views.door_view import door_view
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.model_view import ModelView, TrendDoor
from doormill_ros.recipes.documents import load_recipe
from support.browser import open_page

TEXT, EDGE = 4.5, 3.0  # least contrasts of WCAG 2.2, 1.4.3 and 1.4.11 or 2.4.11
SIZES = {"phone": {"width": 360, "height": 640}, "desktop": {"width": 1280, "height": 900}}
#: Contrast as WCAG 2.2 defines it, of colours that lie on each other as the browser draws them.
CONTRAST = """
const channels = (colour) => {
  const found = colour.match(/^rgba?\\(([^)]+)\\)$/);
  if (!found) throw new Error(`no colour: ${colour}`);
  const [r, g, b, a = 1] = found[1].split(",").map(Number);
  return [r, g, b, a];
};
const over = (top, under) => [0, 1, 2].map((i) => top[i] * top[3] + under[i] * (1 - top[3])).concat(1);
const luminance = ([r, g, b]) => {
  const [x, y, z] = [r, g, b].map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * x + 0.7152 * y + 0.0722 * z;
};
const ratio = (one, other) => {
  const [low, high] = [luminance(one), luminance(other)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
};
const above = (element) => (element ? [...above(element.parentElement), element] : []);
const ground = (element) => above(element).reduce(
  (under, one) => over(channels(getComputedStyle(one).backgroundColor), under),
  channels(getComputedStyle(document.body).backgroundColor),
);
const solid = (element) => above(element).reduce((product, one) => product * getComputedStyle(one).opacity, 1);
const seen = (element) => element.checkVisibility() && element.getBoundingClientRect().width > 1;
"""
TEXTS = (
    "() => {"
    + CONTRAST
    + """
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found = [];
  while (walk.nextNode()) {
    const element = walk.currentNode.parentElement;
    const words = walk.currentNode.textContent.trim();
    if (words && seen(element) && !element.closest("option, title")) found.push([words, element]);
  }
  document.querySelectorAll("input, select").forEach((field) => { if (seen(field)) found.push([field.id, field]); });
  return found.map(([words, element]) => {
    const style = getComputedStyle(element);
    const ink = channels(element.closest("svg") ? style.fill : style.color);
    ink[3] *= solid(element);
    const under = ground(element);
    return [words, ratio(over(ink, under), under)];
  });
}"""
)
FOCUS = (
    "() => {"
    + CONTRAST
    + """
  const element = document.activeElement;
  const style = getComputedStyle(element);
  const reach = parseFloat(style.outlineWidth) + parseFloat(style.outlineOffset);
  const box = element.getBoundingClientRect();
  const cut = above(element.parentElement).filter((one) => {
    if (getComputedStyle(one).overflowX === "visible" || one === document.body) return false;
    const clip = one.getBoundingClientRect();
    return box.left - reach < clip.left || box.right + reach > clip.right
      || box.top - reach < clip.top || box.bottom + reach > clip.bottom;
  });
  const under = ground(element.parentElement);
  const part = (element.closest("section") || element).getBoundingClientRect();
  return {
    id: element.id,
    place: [part.top + scrollY, part.left, box.top + scrollY],
    style: style.outlineStyle,
    width: parseFloat(style.outlineWidth),
    contrast: ratio(channels(style.outlineColor), under),
    cut: cut.length,
  };
}"""
)
#: As when nothing is heard, an order is under way, and a search and an order were answered.
RARE = """() => {
  document.getElementById("lost").hidden = false;
  document.getElementById("mill").disabled = true;
  for (const id of ["found", "answer"]) document.getElementById(id).textContent = "said";
}"""
CONTROLS = """() => [...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]")]
  .filter((element) => element.checkVisibility() && !element.disabled).map((element) => element.id)"""
DRAWING = door_view(load_recipe("standard_door"), "r1")
NAMED = {
    "button",
    "textbox",
    "searchbox",
    "combobox",
    "link",
    "table",
    "columnheader",
    "region",
    "image",
    "progressbar",
    "ProgressIndicator",
    "progressIndicator",
}


def model(stopped: bool) -> ModelView:
    doors = (TrendDoor("oak", "r1", 1, 1e-3), TrendDoor("oak", "r2", 2, 3e-4))
    return ModelView(
        sentence="4 doors, explained by gravity",
        next_measurement="check the scale",
        remarks=("a remark",),
        version=1,
        proposed=3,
        expected=6e-4,
        limit=5e-4,
        stopped=stopped,
        message="stopped",
        doors=doors,
    )


def views(store: Any) -> Iterator[str]:
    """Shows the page in each of its colours; yields the class of what to do next."""
    update = store.update
    update(lambda v: v.with_bridge(True).with_model(model(False)).with_notice("a notice"))
    update(
        lambda v: v.with_ended(EndedRun("r0", "oak", True, 0, "milled", 1.0)).with_handshake(
            "requested", "asks"
        )
    )
    yield "act"
    update(
        lambda v: (
            v.with_run("r1", "oak").with_handshake("milling", "it mills", "r1", "oak").with_drawing(DRAWING)
        )
    )
    yield "danger"
    update(lambda v: v.with_handshake("writing", "targets", "r1", "oak"))
    yield "wait"
    update(lambda v: v.with_ended(EndedRun("r1", "oak", False, 201, "no edge", 2.0)).with_model(model(True)))
    update(lambda v: v.with_handshake("failed", "no edge", "r1", "oak"))
    yield "act refused"
    update(lambda v: v.with_fault("camera", "no light"))
    yield "fault refused"


@pytest.fixture(params=["light", "dark"])
def scheme(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_every_text_stands_out_from_what_is_under_it(controlled: Any, scheme: str) -> None:
    with open_page(controlled.url, color_scheme=scheme) as (page, errors):
        expect(page.locator("#lost")).to_be_hidden()
        for colours in views(controlled.store):
            expect(page.locator("#step")).to_have_attribute("class", colours)
            page.evaluate(RARE)
            found = page.evaluate(TEXTS)
            assert len(found) > 40
            assert [(words, ratio) for words, ratio in found if ratio < TEXT] == []
        # What was looked at in the dark was dark.
        red, green, blue = page.evaluate(
            "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)"
        )
        assert (max(red, green, blue) < 64) is (scheme == "dark")
        assert errors == []


def tabbed(page: Page, most: int = 60) -> list[dict[str, Any]]:
    """Where Tab leads from the beginning of the page until it leaves it."""
    page.evaluate("() => { document.activeElement.blur(); scrollTo(0, 0); }")
    stops: list[dict[str, Any]] = []
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement === document.body"):
            break
        stop = page.evaluate(FOCUS)
        if stops and stop["id"] == stops[0]["id"]:
            break
        stops.append(stop)
    return stops


@pytest.mark.parametrize("size", SIZES)
def test_tab_leads_to_every_control_as_one_reads_and_shows_where_it_is(
    controlled: Any, scheme: str, size: str
) -> None:
    controlled.store.update(
        lambda v: v.with_handshake("requested", "asks").with_model(model(False)).with_drawing(DRAWING)
    )
    controlled.store.update(lambda v: v.with_ended(EndedRun("r" * 40, "oak" * 9, False, 201, "no edge", 2.0)))
    with open_page(controlled.url, color_scheme=scheme, viewport=SIZES[size]) as (page, errors):
        expect(page.locator("#accept")).to_be_visible()
        expect(page.locator("#history tr")).to_have_count(1)
        wanted = page.evaluate(CONTROLS)
        assert {
            "language",
            "token",
            "wanted",
            "mill",
            "cancel",
            "accept",
            "revert",
            "search",
            "export",
        } < set(wanted)
        stops = tabbed(page)
        assert [stop["id"] for stop in stops] == wanted
        # Section after section, those beside each other from left to right, each from its top down.
        places = [stop["place"] for stop in stops]
        assert places == sorted(places)
        for stop in stops:
            assert stop["style"] == "solid", stop
            assert stop["width"] >= 2, stop
            assert stop["contrast"] >= EDGE, stop
            assert stop["cut"] == 0, stop
        assert errors == []


def test_keys_alone_start_a_door_and_search(controlled: Any) -> None:
    with open_page(controlled.url) as (page, errors):
        expect(page.locator("#mill")).to_be_visible()
        press = page.keyboard.press
        page.evaluate("document.activeElement.blur()")
        press("Tab")  # the language
        press("Tab")
        page.keyboard.type(controlled.token)
        press("Tab")
        page.keyboard.type("oak")
        press("Tab")
        press("Enter")
        expect(page.locator("#answer")).to_contain_text("door oak is started")
        page.locator("#cancel").focus()
        press("Tab")
        page.keyboard.type("ash")
        expect(page.locator("#found")).to_have_text("0 of 0 runs found")
        assert controlled.control.orders == ["mill oak"]
        assert errors == []


@pytest.mark.parametrize("locale", ["en", "de", "nb"])
def test_a_screen_reader_has_a_name_for_everything(controlled: Any, locale: str) -> None:
    controlled.store.update(
        lambda v: (
            v.with_ended(EndedRun("r0", "oak", True, 0, "", 1.0))
            .with_run("r1", "oak")
            .with_drawing(DRAWING)
            .with_model(model(True))
        )
    )
    controlled.store.update(lambda v: v.with_drawing(DRAWING).with_model(model(True)))
    with open_page(controlled.url, locale=locale) as (page, errors):
        expect(page.locator("html")).to_have_attribute("lang", locale)
        expect(page.locator("#progress")).to_be_visible()
        expect(page.locator("#history tr")).to_have_count(1)
        # What the browser itself hands to a screen reader.
        tree = page.context.new_cdp_session(page).send("Accessibility.getFullAXTree")["nodes"]
        told = [
            (node["role"]["value"], node.get("name", {}).get("value", ""))
            for node in tree
            if not node["ignored"] and node["role"]["value"] in NAMED
        ]
        roles = [role for role, _ in told]
        for role, least in (
            ("button", 4),
            ("textbox", 3),
            ("searchbox", 1),
            ("table", 1),
            ("columnheader", 4),
        ):
            assert roles.count(role) >= least, (role, roles)
        assert [role for role, name in told if not name.strip()] == []
        assert errors == []
