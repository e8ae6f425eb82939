"""The page's texts: whole in every language, of everything that the monitor can say, and what it says in English."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from string import Formatter
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

import doormill_ros.models.errors
import doormill_ros.monitor.errors
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import CellError, OutOfToleranceError
from doormill_ros.diagnosis.core.changes import DRIFT, STEP
from doormill_ros.diagnosis.core.words import verdict
from doormill_ros.diagnosis.parts.effects.registry import effects
from doormill_ros.diagnosis.parts.telling.next_step import STEPS, NextStep, next_sentence
from doormill_ros.diagnosis.runs.causes import effects_of
from doormill_ros.diagnosis.runs.channels import (
    ANSWER,
    CAMERA,
    LINK,
    MARKS,
    MILLING,
    RESIDUAL,
    SCATTER,
    SPINDLE,
    Channel,
)
from doormill_ros.monitor.finding import ALWAYS, DoorFinding, finding_of
from doormill_ros.monitor.stop import stop_sentence
from doormill_ros.operator.languages import LANGUAGES
from doormill_ros.operator.views.advice import Advice, next_step
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.model_view import ModelView, TrendDoor
from doormill_ros.operator.views.pair_advice import pair_step
from doormill_ros.operator.views.robot_view import DOES
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.robot_model.elastic.causes.registry import CUTTING, LIBRARY
from support.browser import open_page
from support.door_checks import CHECKS

FOLDER = Path(str(files("doormill_ros.operator"))) / "browser"
TEXTS: dict[str, dict[str, str]] = {
    code: json.loads((FOLDER / "texts" / f"{code}.json").read_text()) for code in LANGUAGES
}
ENGLISH = TEXTS["en"]
SCRIPTS = {path.name: path.read_text() for path in FOLDER.glob("*.js")}
PHONE = {"viewport": {"width": 360, "height": 640}, "has_touch": True}
#: What an element says but for what is marked as English.
WITHOUT_ENGLISH = """element => {
  const copy = element.cloneNode(true);
  copy.querySelectorAll("[lang=en]").forEach((part) => part.remove());
  return copy.textContent;
}"""
#: Put together of other texts, the same in all languages.
FRAMES = {
    "last.run",
    "size",
    "drawing.feature",
    "state.age",
    "verdict.no_outlook",
    "state.error",
    "before.name",
    "node",
    "node.robot",
    "drawing.feature.robots",
    "fault",
    "cause.at",
    "run",
    "course.always",
    "change.sizes",
    "change.y",
    "change.z",
}
#: One word in two of the languages.
SHARED = {"model.version", "feature.robots"}
BY_DATA = (
    "outcome.",
    "came.",
    "face.",
    "step.",
    "verdict.",
    "place.",
    "cause.",
    "course.",
    "next.",
    "check.",
    "error.",
    "refused.",
    "answer.",
    "situation.",
    "pair.",
    "before.",
    "stage.",
    "caption.",
    "node.",
)


#: Of a shift that two mills cut: what is wrong with one of them is told at its own name.
MILLS = ("endmill_16", "endmill_20")


def named_effects() -> list[Any]:
    q = np.random.default_rng(3).normal(size=(9, 6))
    return [effect for effect in effects(tuple(FEATURES), MILLS, q, warming=True, places=100) if effect.named]


def fields(text: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_text_is_missing_in_a_language(code: str) -> None:
    texts = TEXTS[code]
    assert set(texts) == set(ENGLISH)
    for key, text in texts.items():
        assert text.strip(), key
        assert fields(text) == fields(ENGLISH[key]), key
        # What is appended begins, and what goes on ends, in the same way.
        assert (text[0] in ",;", text[-1] in ".:…") == (ENGLISH[key][0] in ",;", ENGLISH[key][-1] in ".:…"), (
            key
        )
        if code != "en" and key not in FRAMES | SHARED:
            assert text != ENGLISH[key], f"{key} was copied"


def places() -> set[str]:
    library = {where for kind in (*LIBRARY, *CUTTING) for where in kind.places or ()}
    found = library | {effect.where for effect in named_effects()} | set(FEATURES)
    found -= set(MILLS)  # Their names are the owner's, and no language has words for them.
    return {re.sub(r"^(joint|link) \d+$", r"\1", where) for where in found}


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_cause_of_the_registries_has_a_name_and_every_place(code: str) -> None:
    causes = {kind.name for kind in (*LIBRARY, *CUTTING)} | {effect.name for effect in named_effects()}
    assert len(causes) > 20
    wanted = {f"cause.{name}" for name in causes} | {f"place.{where}" for where in places()}
    assert wanted <= set(TEXTS[code])
    names = [TEXTS[code][f"cause.{name}"] for name in causes]
    assert len(set(names)) == len(names), "two causes of one name"


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_change_that_bags_alone_tell_has_a_name(code: str) -> None:
    assert len(CHANGED) == 9
    texts = TEXTS[code]
    names = [texts[f"cause.{cause}"] for cause, _ in CHANGED]
    assert len(set(names)) == len({cause for cause, _ in CHANGED}), "two changes of one name"
    own = {where for _, where in CHANGED} - {"touch_probe"}
    assert {f"place.{'connection' if where == 'link' else where}" for where in own} <= set(texts)


@pytest.mark.parametrize("code", LANGUAGES)
def test_everything_that_the_monitor_can_say_has_a_text(code: str) -> None:
    rows = [
        error
        for module in (doormill_ros.models.errors, doormill_ros.monitor.errors)
        for error in vars(module).values()
        if isinstance(error, type) and issubclass(error, CellError) and error is not CellError
    ]
    assert len(rows) == 10
    verdicts = (verdict.CONSISTENT, verdict.EXPLAINED, verdict.PARTLY_EXPLAINED, verdict.UNEXPLAINED)
    wanted = {f"error.{error.code}" for error in rows} | {f"verdict.{one}" for one in verdicts}
    wanted |= {f"next.{step}" for step in STEPS} | {f"check.{cause}" for cause in CHECKS}
    wanted |= {f"course.{course}" for course in (ALWAYS, STEP, DRIFT)}
    assert wanted <= set(TEXTS[code])
    assert all(ENGLISH[f"error.{error.code}"] == error.__doc__ for error in rows)
    assert {key for key in ENGLISH if key.startswith("check.")} == {f"check.{cause}" for cause in CHECKS}
    assert all(ENGLISH[f"check.{cause}"] == words for cause, words in CHECKS.items())


def advice() -> Iterator[Advice]:
    """Everything that the page can say to do."""
    yield next_step(False, "", False, "", {})
    for state in [*(state.value for state in HandshakeState), "nobody knows"]:
        for in_hand in (False, True):
            for more in ({}, {"spoiled": True}, {"milled": True}, {"stopped": "too far off {limit}"}):
                for refusal in ("", "no edge"):
                    yield next_step(True, state, in_hand, refusal, {}, **more)
        yield next_step(True, state, False, "", {"a_node": "a {fault}"})
    for both in itertools.product((*DOES, "nobody knows"), repeat=2):
        does = dict(zip((1, 2), both, strict=True))
        for refused, spoiled, lacking in itertools.product((False, True), repeat=3):
            for milled in ((), (1,)):
                yield pair_step(does, False, refused, {}, spoiled, milled, lacking)
        yield pair_step(does, True, False, {})


def test_every_next_step_has_its_text_and_says_the_same_in_english() -> None:
    found = {step.key: step for step in advice()}
    assert {f"step.{key}" for key in found} == {key for key in ENGLISH if key.startswith("step.")}
    for step in found.values():
        assert step.text == ENGLISH[f"step.{step.key}"].format(**step.values)


class Marked(HTMLParser):
    """What stands in page.html under the key of a text."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, str]] = []
        self._key = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self._key = given.get("data-text", "")
        for key, shown in (("data-label", "aria-label"), ("data-alt", "alt")):
            if key in given:
                self.found.append((given[key], given[shown]))

    def handle_data(self, data: str) -> None:
        if self._key and data.strip():
            self.found.append((self._key, data))
            self._key = ""


def test_the_page_as_it_is_sent_is_the_english_one() -> None:
    marked = Marked()
    marked.feed((FOLDER / "page.html").read_text())
    assert len(marked.found) > 30
    assert [(key, shown) for key, shown in marked.found if ENGLISH.get(key) != shown] == []


def test_every_text_is_used_and_every_used_one_is_there() -> None:
    page = (FOLDER / "page.html").read_text()
    used = set(re.findall(r'data-(?:text|label|alt)="([^"]+)"', page))
    for script in SCRIPTS.values():
        used |= {word for word in re.findall(r'"([a-z_.0-9]+)"', script) if word in ENGLISH}
        called = re.findall(r'\btext\("([^"]+)"', script)
        assert [key for key in called if key not in ENGLISH] == []
    assert {key for key in ENGLISH if not key.startswith(BY_DATA)} - used == set()


def document(
    kind: str, causes: list[tuple[str, str]], changes: list[dict[str, str]], doors: int
) -> dict[str, Any]:
    return {
        "verdict": kind,
        "causes": [{"cause": cause, "where": where} for cause, where in causes],
        "changes": changes,
        "in_use": {"expected_error": 6.4e-4, "expected_error_extended": 3.6e-4, "difference": 1e-3},
        "noise_floor": 1e-5,
        "inspections": [{}] * doors,
        "remarks": ["joint backlash at joint 1 drifts from oak to elm."],
        "next_measurement": "",
        "next": [],
    }


def channel(source: str, axis: int) -> Channel:
    none = np.zeros(0)
    return Channel(source, axis, none, 0.0, 0.0, none, none)


#: What bags alone can name, of a cell with everything, once each.
CHANGED = list(
    dict.fromkeys(
        (effect.name, effect.where)
        for effect in effects_of(
            [channel(source, 0) for source in (CAMERA, MARKS, "touch_probe")]
            + [channel(source, -1) for source in (RESIDUAL, SCATTER, MILLING, ANSWER, LINK, SPINDLE)]
        )
    )
)


#: Once each: what several sizes of one are tried of is named once.
CAUSES = list(dict.fromkeys((effect.name, effect.where) for effect in named_effects()))
CHANGES = [
    {"what": "process_force", "where": "tool", "kind": STEP, "from_run": "r7"},
    {"what": "gravity_sag", "where": "link 3", "kind": DRIFT, "from_run": "r8"},
]
FOUND = [
    finding_of(document("consistent", [], [], 1), {}),
    finding_of(document("explained", CAUSES, CHANGES, 4), {"r7": "oak"}),
    finding_of(document("partly_explained", CAUSES[:2], [], 15), {}),
    finding_of(document("unexplained", [], [], 2), {}),
]
NEXT = (
    NextStep("points", "joint_stiffness", "process_force", points=140, feature="hinge_1", recipe="oak"),
    *(NextStep("check", cause, "tool_bending", by=cause) for cause in CHECKS),
    NextStep("check", "joint_hardening", "joint_friction"),
    *(NextStep(step) for step in STEPS if step not in ("points", "check")),
)
STOPS = [(6.4e-4, 5e-4, 0, 3, 3.6e-4), (9.1e-4, 5e-4, 2, 3, 7.25e-4), (6.4e-4, 5e-4, 4, 0, -1.0)]


def view_of(
    found: DoorFinding, stop: tuple[float, float, int, int, float] = STOPS[0], **more: Any
) -> ModelView:
    expected, limit, version, proposed, left = stop
    return ModelView(
        sentence=found.sentence,
        next_measurement=next_sentence(NEXT, CHECKS),
        remarks=found.remarks,
        version=version,
        proposed=proposed,
        expected=expected,
        expected_proposed=left,
        limit=limit,
        verdict=found.verdict,
        causes=found.faults,
        questioned=found.questioned,
        next_steps=NEXT,
        doors=(TrendDoor("oak", "r1", 0, 3e-4), TrendDoor("elm", "r2", 1, 7e-4)),
        **{"stopped": True, "message": stop_sentence(*stop), "waiting": 2, "asking": True} | more,
    )


def said(page: Page, function: str, model: ModelView) -> str:
    """What a function of the page makes of a verdict, in the language that the page speaks."""
    script = "([name, found]) => import('/monitor_words.js').then((words) => words[name](found))"
    return str(page.evaluate(script, [function, model.document()]))


def test_the_data_of_a_verdict_say_all_that_the_monitor_says(read_only: Any) -> None:
    """Said in English they are the monitor's own words, so nothing of those is lost in another language."""
    with open_page(read_only.url) as (page, errors):
        expect(page.locator("#state")).to_have_text("unknown")
        for found in FOUND:
            assert said(page, "verdictSentence", view_of(found)) == found.sentence
        own = next_sentence(NEXT, CHECKS)
        assert said(page, "nextSentence", view_of(FOUND[0])) == re.sub(r"(?<=[a-z])_(?=[a-z])", " ", own)
        for stop in STOPS:
            assert said(page, "stopReason", view_of(FOUND[0], stop)) == stop_sentence(*stop)
        assert errors == []


@pytest.mark.parametrize(
    ("locale", "code", "words"),
    [
        (
            "de-AT",
            "de",
            ("4 Türen, erklärt durch: ", "Prozesskraft am Werkzeug (neu oder verändert ab Lauf r7, Tür oak)"),
        ),
        (
            "nb-NO",
            "nb",
            ("4 dører, forklart av ", "prosesskraft ved verktøyet (ny eller endret fra kjøring r7, dør oak)"),
        ),
        ("nn-NO", "nb", ("nedbøyning av egenvekt i armledd 3 (driver fra kjøring r8)",)),
        ("fr-FR", "en", ("4 doors, explained by ", "gravity sag at link 3 that drifts from run r8 on")),
    ],
)
def test_the_page_speaks_the_browsers_language(
    guarded: Any, locale: str, code: str, words: tuple[str, ...]
) -> None:
    texts, model = TEXTS[code], view_of(FOUND[1], error_code=842)
    guarded.store.update(lambda view: view.with_bridge(True).with_handshake("idle", "").with_model(model))
    with open_page(guarded.url, locale=locale, **PHONE) as (page, errors):
        expect(page.locator("html")).to_have_attribute("lang", code)
        for part in words:
            expect(page.locator("#verdict")).to_contain_text(part)
        expect(page.locator("#accept")).to_have_text(texts["accept.version"].format(version=3))
        number = "0.64 mm" if code == "en" else "0,64 mm"
        for place in ("#verdict", "#expected", "#model-message", "#next-step"):
            expect(page.locator(place)).to_contain_text(number)
        expect(page.locator("#trend-caption")).to_contain_text(texts["trend"].partition("{count}")[0])
        if code != "en":
            expect(page.locator("#model-message")).to_contain_text(texts["error.842"])
            # What the data do not hold is told in the monitor's words, and said to be English.
            expect(page.locator("#model-words")).to_have_text(model.message)
            expect(page.locator("#model-words")).to_have_attribute("lang", "en")
            english = {text for text in ENGLISH.values() if len(text) > 12 and not fields(text)}
            shown = page.locator("#model").evaluate(WITHOUT_ENGLISH)
            assert [text for text in english if text in shown] == []
        assert errors == []


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_longest_words_fit_a_phone(guarded: Any, code: str) -> None:
    model = view_of(FOUND[1], error_code=840)
    spoiled = EndedRun("r1", "standard_door", False, OutOfToleranceError.code, "1.60 mm off", 1.0, True)
    guarded.store.update(lambda view: view.with_handshake("idle", "").with_ended(spoiled).with_model(model))
    with open_page(guarded.url, locale=code, **PHONE) as (page, errors):
        expect(page.locator("#last")).to_contain_text(TEXTS[code]["outcome.out_of_tolerance"])
        expect(page.locator("#model-control")).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth") <= 360
        for name in (
            "accept",
            "revert",
            "mill",
            "cancel",
            "language",
            "verdict",
            "measure-next",
            "model-message",
        ):
            box = page.locator(f"#{name}").bounding_box()
            assert box is not None
            assert box["x"] >= 0, name
            assert box["x"] + box["width"] <= 360, name
            inside = "e => e.scrollWidth <= e.clientWidth && e.scrollHeight <= e.clientHeight"
            assert page.locator(f"#{name}").evaluate(inside), name
        # What to do now is seen without a touch.
        box = page.locator("#next-step").bounding_box()
        assert box is not None
        assert box["y"] <= 200
        assert errors == []


def test_a_chosen_language_is_kept_and_everything_follows(guarded: Any) -> None:
    guarded.store.update(lambda view: view.with_handshake("idle", "").with_model(view_of(FOUND[1])))
    with open_page(guarded.url) as (page, errors):
        expect(page.locator("#accept")).to_have_text("Accept version 3")
        page.locator("#language").select_option("de")
        expect(page.locator("#accept")).to_have_text("Version 3 annehmen")
        expect(page.locator("#cancel")).to_have_text(TEXTS["de"]["cancel"])
        expect(page).to_have_title(TEXTS["de"]["title"])
        expect(page.locator("#next-step")).to_contain_text("Keine Tür fräsen")
        page.reload()
        expect(page.locator("#accept")).to_have_text("Version 3 annehmen")
        page.locator("#language").select_option("en")
        expect(page.locator("#verdict")).to_have_text(FOUND[1].sentence)
        assert errors == []


def test_orders_are_answered_in_the_readers_language(guarded: Any) -> None:
    guarded.store.update(lambda view: view.with_model(view_of(FOUND[1])))
    texts = TEXTS["nb"]
    with open_page(guarded.url, locale="nb-NO") as (page, _):
        answer = page.locator("#model-answer")
        expect(page.locator("#accept")).to_be_enabled()
        page.locator("#accept").click()
        expect(answer).to_have_text(texts["refused.401"])
        page.locator("#token").fill(guarded.keys.engineer or "")
        page.locator("#accept").click()
        expect(answer).to_have_text(texts["wrong.order"])
        page.locator("#who").fill("Kari")
        page.locator("#why").fill("seen on 15 doors")
        page.locator("#accept").click()
        expect(answer).to_have_text(texts["answer.accept"].format(version=3))
        guarded.store.update(lambda view: view.with_model(view_of(FOUND[1], (6e-4, 5e-4, 0, 99, 3e-4))))
        # The page orders the version that it shows: until the new one has come, that is 3.
        expect(page.locator("#accept")).to_have_text(texts["accept.version"].format(version=99))
        page.locator("#accept").click()
        expect(answer).to_contain_text(texts["error.831"])
        expect(answer).to_contain_text("version 99 of the model was never proposed")
    assert guarded.control.orders == ["accept 3, Kari: seen on 15 doors"]
