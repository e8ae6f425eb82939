"""The page and the model of the robot: who may change it, what is written down, and what everybody sees."""

from __future__ import annotations

import json
from typing import Any

import pytest
from playwright.sync_api import expect

from doormill_ros.operator.access.token import Keys
from doormill_ros.operator.orders.audit import ORDERS
from doormill_ros.operator.views.model_view import ModelView, TrendDoor
from doormill_ros.operator.views.short_text import LONGEST_TEXT
from doormill_ros.operator.views.state import CellView
from support.browser import open_page

ORDER = {"version": 3, "who": "Kari", "why": "15 doors say so"}
NASTY = "<img src=x onerror=\"document.title='broken'\">"
DOORS = tuple(TrendDoor("oak", f"r{k}", int(k > 1), 3e-4 + 1e-4 * k) for k in range(4))
MODEL = ModelView(
    sentence="4 doors, explained by process force at tool",
    next_measurement="mill a test cut at half the feed",
    remarks=("The features lie in 2 places of the cell.",),
    proposed=3,
    expected=6.4e-4,
    expected_proposed=3.6e-4,
    limit=5e-4,
    stopped=True,
    message="the next door is expected to be 0.64 mm off where 0.50 mm are allowed",
    waiting=2,
    doors=DOORS,
)


@pytest.mark.parametrize("path", ["control/accept", "control/revert"])
def test_only_the_engineer_changes_the_model(guarded: Any, path: str) -> None:
    keys = guarded.keys
    answers = [guarded.order(token, path, json=ORDER).status_code for token in (None, "wrong", keys.operate)]
    assert answers == [401, 401, 403]
    assert guarded.control.orders == []
    answer = guarded.order(keys.engineer, path, json=ORDER)
    assert answer.status_code == 200
    assert guarded.control.orders == [f"{path.rpartition('/')[2]} 3, Kari: 15 doors say so"]


@pytest.mark.parametrize(
    "change",
    [{"version": 0}, {"version": 2**32}, {"version": "x"}, {"who": ""}, {"why": ""}, {"why": "y" * 501}],
)
def test_what_is_no_order_is_not_passed_on(guarded: Any, change: dict[str, Any]) -> None:
    answer = guarded.order(guarded.keys.engineer, "control/accept", json=ORDER | change)
    assert answer.status_code == 422
    assert guarded.control.orders == []


def test_orders_about_the_model_are_in_the_audit_log(guarded: Any) -> None:
    engineer = guarded.keys.engineer
    guarded.order(engineer, "control/accept", json=ORDER)
    guarded.order(engineer, "control/accept", json=ORDER | {"version": 99})
    guarded.order(engineer, "control/revert", json=ORDER)
    guarded.order(guarded.keys.operate, "control/revert", json=ORDER)
    found = [json.loads(line) for line in (guarded.folder / ORDERS).read_text().splitlines()]
    assert [(e["role"], e["order"], e["outcome"], e["status"]) for e in found] == [
        ("engineer", "POST /control/accept", "accepted", 200),
        ("engineer", "POST /control/accept", "refused", 409),
        ("engineer", "POST /control/revert", "accepted", 200),
        ("operate", "POST /control/revert", "refused", 403),
    ]
    assert [e["message"] for e in found[:3]] == [
        "version 3 is in use",
        "version 99 of the model was never proposed",
        "version 0 is in use",
    ]


def test_nothing_is_changed_that_cannot_be_written_down(guarded: Any) -> None:
    guarded.folder.mkdir(parents=True)
    (guarded.folder / ORDERS).mkdir()
    answer = guarded.order(guarded.keys.engineer, "control/accept", json=ORDER)
    assert answer.status_code == 409
    assert guarded.control.orders == []


def test_a_stop_is_the_next_step_unless_a_door_is_in_hand() -> None:
    view = CellView(bridge_present=True, state="requested").with_model(MODEL)
    document = view.document()
    assert "0.64 mm off" in document["next_step"]
    assert document["urgency"] == "act"
    assert document["model"]["sentence"] == MODEL.sentence
    assert "0.64 mm" not in view.with_run("r1", "oak").document()["next_step"]
    assert "Stay out" in CellView(True, "milling").with_model(MODEL).document()["next_step"]


def test_long_words_of_the_monitor_are_cut() -> None:
    long = "x" * (2 * LONGEST_TEXT)
    view = CellView().with_model(
        ModelView(sentence=long, remarks=(long,), message=long, next_measurement=long)
    )
    model = view.document()["model"]
    texts = (model["sentence"], model["remarks"][0], model["message"], model["next_measurement"])
    assert [len(text) for text in texts] == [LONGEST_TEXT] * 4


def test_everybody_sees_the_verdict_the_trend_and_what_to_measure_next(either: Any) -> None:
    with open_page(either.url) as (page, errors):
        expect(page.locator("#model")).to_be_hidden()
        either.store.update(lambda view: view.with_model(MODEL))
        expect(page.locator("#verdict")).to_have_text(MODEL.sentence)
        expect(page.locator("#measure-next")).to_have_text(
            "Measure this next: mill a test cut at half the feed."
        )
        expect(page.locator("#model-message")).to_have_text(MODEL.message)
        expect(page.locator("#expected")).to_contain_text("0.64 mm; 2 inspections wait")
        expect(page.locator("#version")).to_contain_text("version 3 is proposed: 0.36 mm")
        expect(page.locator("#trend-caption")).to_contain_text("last 4 inspected doors")
        assert page.locator("#trend circle").count() == 4
        assert page.locator("#trend circle.beyond").count() == sum(d.largest > MODEL.limit for d in DOORS)
        assert page.locator("#trend line.version").count() == 1
        assert page.locator("#model-control").is_visible() == (either.control is not None)
        assert errors == []


def test_the_engineer_accepts_with_name_reason_and_token(guarded: Any) -> None:
    keys: Keys = guarded.keys
    guarded.store.update(lambda view: view.with_model(MODEL))
    with open_page(guarded.url) as (page, errors):
        expect(page.locator("#accept")).to_have_text("Accept version 3")
        expect(page.locator("#revert")).to_be_disabled()
        page.locator("#accept").click()
        expect(page.locator("#model-answer")).to_contain_text("token is missing")
        page.locator("#token").fill(keys.engineer or "")
        page.locator("#accept").click()
        expect(page.locator("#model-answer")).to_have_text("your name and why are wanted")
        assert guarded.control.orders == []
        page.locator("#who").fill(NASTY)
        page.locator("#why").fill("seen on 15 doors")
        page.locator("#accept").click()
        expect(page.locator("#model-answer")).to_have_text("version 3 is in use")
        assert guarded.control.orders == [f"accept 3, {NASTY}: seen on 15 doors"]
        assert page.title() == "Door milling cell"
        assert len(errors) == 2  # the browser reports the refused tries
