"""The page of two robots contradicts neither, names the one that a step is about, and tells whose a feature is."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator
from importlib.resources import files
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from playwright.sync_api import Page, expect

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.operator.languages import LANGUAGES
from doormill_ros.operator.views.door_view import door_view, robots_of
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.robot_view import DOES, RobotView
from doormill_ros.operator.views.situation import MOVING
from doormill_ros.operator.views.state import CellView
from doormill_ros.recipes.documents import load_recipe, shipped_recipes
from doormill_ros.toolpath.settings import load_settings
from support.browser import TABLET, open_page

TEXTS = {
    code: json.loads(
        (files("doormill_ros.operator") / f"browser/texts/{code}.json").read_text(encoding="utf-8")
    )
    for code in LANGUAGES
}
STATES = [state.value for state in HandshakeState]
PHONE = {"viewport": {"width": 360, "height": 640}, "has_touch": True}
RECIPE = load_recipe("standard_door")


def robots(view: CellView, first: str, second: str, run_id: str = "r1", code: int = 0) -> CellView:
    """Both handshakes told, each about the run unless it is about none."""
    for number, state in ((1, first), (2, second)):
        of_run = "" if state in ("clearing", "idle", "requested") else run_id
        reason = f"why {number}" if state == "failed" else ""
        told = state, reason, of_run, state == "requested", 1.0, code if state == "failed" else 0
        view = view.with_robot_handshake(number, *told)
    return view


def begun(run_id: str = "r1") -> CellView:
    """Both controllers asked, a door is in hand."""
    view = robots(CellView(), "requested", "requested").with_run(run_id, RECIPE.door_id)
    return view.with_drawing(door_view(RECIPE, run_id, load_settings()))


def ended(run_id: str, success: bool, message: str = "", code: int = 491) -> EndedRun:
    return EndedRun(run_id, "door", success, 0 if success else code, message, 1.0)


def told(view: CellView) -> tuple[str, str, str]:
    """State with its sentence, key of the next step and its urgency."""
    document = view.document()
    return f"{document['state']}: {document['state_reason']}", document["step"]["key"], document["urgency"]


def test_a_door_from_both_asking_to_milled() -> None:
    assert told(robots(CellView(), "idle", "idle"))[1] == "next_door_both"
    view = robots(CellView(), "requested", "idle")
    assert told(view) == (
        "idle: the controller of robot 1 asks for targets; the controller of robot 2 asks for nothing",
        "next_door_of",
        "act",
    )
    assert view.document()["next_step"] == "Clamp the next door, then start the program of robot 2."
    assert told(robots(CellView(), "requested", "requested"))[1] == "start_both"
    view = begun()
    assert told(view)[1:] == ("wait", "wait")
    view = robots(view.with_stage("milling", 0.4), "milling", "requested")
    assert told(view) == ("milling: robot 1 mills; robot 2 waits for its turn", "stay_out_of", "danger")
    assert view.document()["next_step"] == "Stay out of the cell. Robot 1 mills the door."
    view = robots(view, "done", "requested")
    assert told(view)[1:] == ("about_to_move_of", "danger")
    assert view.document()["step"]["values"] == {"robot": "2"}
    # The first controller's program asks anew while the second robot mills: its share is milled all the same.
    view = robots(view, "requested", "milling")
    assert told(view) == ("milling: robot 1 has milled its share; robot 2 mills", "stay_out_of", "danger")
    view = robots(view, "done", "done")
    assert told(view)[1] == "closing"
    view = view.with_ended(ended("r1", True))
    assert told(view) == (
        "done: robot 1 has milled its share; robot 2 has milled its share",
        "done_both",
        "act",
    )


def test_one_refused_ends_the_door() -> None:
    view = robots(begun().with_stage("milling", 0.4), "failed", "requested", code=491)
    assert told(view)[1] == "closing"
    assert view.document()["state_code"] == 491
    view = view.with_ended(ended("r1", False, "first robot: the spindle does not turn"))
    sentence, key, _ = told(view)
    assert sentence.startswith(
        "failed: the last run of robot 1 came to nothing; the controller of robot 2 asks"
    )
    assert sentence.endswith("; robot 1: why 1")
    assert key == "not_milled_both"
    assert view.document()["history"][0]["outcome"] == "refused (491)"


def test_a_half_milled_door_is_not_said_to_be_unmilled() -> None:
    view = robots(robots(begun().with_stage("milling", 0.7), "done", "milling"), "done", "failed")
    view = view.with_ended(ended("r1", False, "second robot: no air; the first robot has milled its share"))
    assert told(view)[1] == "half_milled"
    assert view.document()["next_step"].startswith("The door is half milled: robot 1 has milled its share")
    # Also for a page that is started after that, which has the run from its history.
    late = robots(CellView(history=view.history), "done", "failed")
    assert told(late)[1] == "half_milled"
    # The second one milled on to its end.
    after = robots(view, "done", "done")
    assert told(after)[1] == "milled_after_all_both"
    spoiled = robots(begun(), "done", "done").with_ended(
        ended("r1", False, "1.6 mm", OutOfToleranceError.code)
    )
    assert told(spoiled)[1] == "spoiled_both"


@pytest.mark.parametrize("state", STATES)
def test_a_silent_bridge_is_named_and_never_shown_as_an_old_state(state: str) -> None:
    view = robots(begun(), state, "requested").with_robot(1, lambda robot: robot.heard(False))
    document = view.document()
    assert document["next_step"].startswith("Nothing is known of robot 1: /robot1/abb_bridge does not answer")
    assert document["state_reason"].startswith("nothing is known of robot 1; ")
    assert document["robots"][0]["state"] == ""
    neither = view.with_robot(2, lambda robot: robot.heard(False)).document()
    assert (neither["state"], neither["step"]["key"]) == ("", "silent_both")


@pytest.mark.parametrize(("first", "second"), list(itertools.product(MOVING, STATES)))
@pytest.mark.parametrize("in_hand", [False, True])
@pytest.mark.parametrize("swapped", [False, True])
def test_nothing_hides_that_a_robot_may_move(first: str, second: str, in_hand: bool, swapped: bool) -> None:
    view = begun() if in_hand else CellView()
    view = robots(view, second, first) if swapped else robots(view, first, second)
    document = view.with_fault("path_generator", "broken").document()
    assert document["urgency"] == "danger"
    assert re.search(r"Stay out .* Robot [12]", document["next_step"])


@pytest.mark.parametrize("code", [0, 450])
def test_a_link_that_is_cleared_does_not_hide_that_the_robot_may_move(code: int) -> None:
    """The bridge clears the link after the handover, while the robot mills, and for as long as the link is broken."""
    view = robots(begun().with_stage("milling", 0.4), "acknowledged", "requested")
    view = view.with_robot_handshake(1, "clearing", "file handed over", "r1", True, 1.0, code)
    sentence, key, urgency = told(view)
    assert sentence.startswith(
        "clearing: robot 1 may move, and the link to it is being cleared; robot 2 waits for"
    )
    assert (key, urgency) == ("about_to_move_of", "danger")
    # Before anything was handed over there is nothing to be kept from.
    early = begun().with_robot_handshake(1, "clearing", "no link", "", False, 1.0, 450)
    assert told(early)[1:] == ("clearing", "wait")


def test_a_robot_with_nothing_to_mill_is_not_waited_for() -> None:
    names = {name: robots_of(load_recipe(name), load_settings()) for name in shipped_recipes()}
    hinges = next(name for name, of in names.items() if {n for own in of.values() for n in own} == {1})
    view = robots(CellView(), "requested", "idle").with_run("r1", hinges)
    view = view.with_drawing(door_view(load_recipe(hinges), "r1", load_settings()))
    assert told(view) == (
        "requested: the controller of robot 1 asks for targets; robot 2 has nothing to mill at this door",
        "wait",
        "wait",
    )
    view = robots(robots(view, "milling", "idle"), "done", "idle")
    assert told(view)[1] == "closing"
    assert told(view.with_ended(ended("r1", True)))[1] == "done_both"
    broken = view.with_ended(ended("r1", False, "given up"))
    assert told(broken)[1] == "milled_after_all_both"


_RUNS = st.sampled_from(["r1", "r2", "r3"])
_CHANGES = st.one_of(
    st.tuples(
        st.just("with_robot_handshake"),
        st.sampled_from([1, 2]),
        st.sampled_from([*STATES, "nobody knows"]),
        st.just("why"),
        st.one_of(st.just(""), _RUNS),
        st.booleans(),
        st.just(1.0),
        st.just(0),
    ),
    st.tuples(st.just("with_run"), _RUNS, st.text()),
    st.tuples(
        st.just("with_robot"),
        st.sampled_from([1, 2]),
        st.booleans().map(lambda present: lambda robot: robot.heard(present)),
    ),
    st.tuples(st.just("with_ended"), st.builds(ended, _RUNS, st.booleans(), st.text())),
    st.tuples(st.just("with_fault"), st.text(), st.text()),
    st.tuples(st.just("with_drawing"), _RUNS.map(lambda run: door_view(RECIPE, run, load_settings()))),
)


@given(st.lists(_CHANGES, max_size=20))
def test_no_order_of_messages_makes_the_page_contradict_a_robot(changes: list[tuple[Any, ...]]) -> None:
    view = CellView().with_robot(1, lambda robot: robot)
    for name, *arguments in changes:
        view = getattr(view, name)(*arguments)
    document = json.loads(json.dumps(view.document()))
    assert document["next_step"]
    assert view.pair is not None
    states = [robot.state if robot.present else "" for robot in view.pair.robots]
    step = document["next_step"]
    if "" in states:
        assert "Nothing is known" in step
    elif any(state in MOVING for state in states):
        assert "Stay out" in step
        named = re.search(r"Robot (\d)", step)
        assert named is not None
        assert states[int(named[1]) - 1] in MOVING
    does = {robot["robot"]: robot["does"] for robot in document["robots"]}
    for number, state in enumerate(states, 1):
        assert (does[number] == "milling") == (state == "milling")
        assert (does[number] == "silent") == (state == "")
    assert not ("milled its share" in document["state_reason"] and step.startswith("The door was not milled"))


def test_what_came_of_the_features_follows_both_robots() -> None:
    whose = robots_of(RECIPE, load_settings())
    assert set(whose.values()) == {(1,), (2,), (1, 2)}

    def came(view: CellView) -> dict[tuple[int, ...], set[str]]:
        drawn = view.document()["drawing"]
        found: dict[tuple[int, ...], set[str]] = {}
        for feature in drawn["features"]:
            assert tuple(share["robot"] for share in feature["shares"]) == whose[feature["name"]]
            found.setdefault(whose[feature["name"]], set()).add(feature["came_to"])
        return found

    view = begun().with_stage("milling", 0.4)
    assert came(view) == {(1,): {"planned"}, (2,): {"planned"}, (1, 2): {"planned"}}
    view = robots(view, "milling", "requested")
    assert came(view) == {(1,): {"in_work"}, (2,): {"planned"}, (1, 2): {"in_work"}}
    view = robots(view, "done", "requested")
    assert came(view) == {(1,): {"milled"}, (2,): {"planned"}, (1, 2): {"half_milled"}}
    second = robots(view, "done", "milling")
    assert came(second) == {(1,): {"milled"}, (2,): {"in_work"}, (1, 2): {"in_work"}}
    broken = robots(second, "done", "failed").with_ended(ended("r1", False))
    assert came(broken) == {(1,): {"milled"}, (2,): {"not_milled"}, (1, 2): {"half_milled"}}
    names = list(whose)
    milled = robots(second, "done", "done").with_ended(ended("r1", True))
    assert came(milled) == {(1,): {"milled"}, (2,): {"milled"}, (1, 2): {"milled"}}
    measured = milled.with_measured("r1", dict.fromkeys(names, 2e-4), 5e-4)
    assert set().union(*came(measured).values()) == {"within"}


def test_each_robot_has_a_plan_of_its_own() -> None:
    half = next(name for name, own in robots_of(RECIPE, load_settings()).items() if own == (1, 2))
    view = begun().with_plan("r1", {half: (1.0, 2.0)}, 1).with_plan("r1", {half: (5.0, 6.0)}, 2)
    shown = next(one for one in view.document()["drawing"]["features"] if one["name"] == half)
    assert [(share["begin"], share["end"]) for share in shown["shares"]] == [(1.0, 2.0), (5.0, 6.0)]


def test_a_page_of_one_robot_tells_of_no_pair() -> None:
    view = CellView().with_handshake("idle", "").with_run("r1", "oak").with_drawing(door_view(RECIPE, "r1"))
    document = view.document()
    assert document["robots"] == []
    assert all(feature["shares"] == [] for feature in document["drawing"]["features"])


@pytest.fixture(params=[TABLET, PHONE], ids=["tablet", "phone"])
def pair(read_only: Any, request: pytest.FixtureRequest) -> Iterator[tuple[Any, Page, list[str]]]:
    read_only.store.update(lambda view: begun().with_stage("milling", 0.4))
    with open_page(read_only.url, **request.param) as (page, errors):
        yield read_only.store, page, errors


def test_the_browser_shows_whose_features_they_are_and_how_far_both_are(
    pair: tuple[Any, Page, list[str]],
) -> None:
    store, page, errors = pair
    whose = robots_of(RECIPE, load_settings())
    numbers = sorted(" + ".join(map(str, own)) for own in whose.values())
    expect(page.locator("#drawing-features tr")).to_have_count(len(whose))
    listed = page.locator("#drawing-features .whose").all_text_contents()
    assert sorted(listed) == [f"Robot {own}" for own in numbers]
    drawn = page.locator("#drawing text.on-wood, #drawing text.beside").all_text_contents()
    assert sorted(drawn) == numbers
    own = [sum(number in robots for robots in whose.values()) for number in (1, 2)]
    rows = page.locator("#drawing-robots li")
    expect(rows).to_have_text([f"Robot {n}: 0 of {own[n - 1]} features milled" for n in (1, 2)])
    names = [name for name, robots in whose.items() if 1 in robots]
    plan = {name: (0.0, 1e-3) if number == 0 else (0.0, 1e6) for number, name in enumerate(names)}
    store.update(lambda view: robots(view.with_plan("r1", plan, 1), "milling", "requested"))
    expect(page.locator("#state")).to_have_text("milling: robot 1 mills; robot 2 waits for its turn")
    expect(rows.first).to_have_text(f"Robot 1: 1 of {own[0]} features milled")
    store.update(lambda view: robots(view, "done", "milling"))
    expect(rows.first).to_have_text(f"Robot 1: {own[0]} of {own[0]} features milled")
    expect(page.locator("#next-step")).to_have_text("Stay out of the cell. Robot 2 mills the door.")
    width = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert width <= 0
    assert errors == []


@pytest.mark.parametrize("code", ["de", "nb"])
def test_other_languages_tell_what_both_do_and_whose_fault_it_is(read_only: Any, code: str) -> None:
    texts = TEXTS[code]
    view = robots(begun(), "milling", "requested").with_fault("robot2/abb_bridge", "no link", 450)
    read_only.store.update(lambda _: view)
    with open_page(read_only.url, locale=code, **PHONE) as (page, errors):
        both = texts["pair.milling"].format(robot=1), texts["pair.turn"].format(robot=2)
        expect(page.locator("#state")).to_have_text("; ".join(both))
        expect(page.locator("#next-step")).to_have_text(texts["step.stay_out_of"].format(robot=1))
        named = texts["node.robot"].format(robot=2, said=texts["node.abb_bridge"])
        expect(page.locator("#faults strong")).to_contain_text(named)
        whose = page.locator("#drawing-features .whose").first
        expect(whose).to_have_text(texts["feature.robots"].format(robots=1))
        assert errors == []


@pytest.mark.parametrize("does", sorted(DOES))
def test_what_a_robot_does_has_a_text_that_says_the_same_in_english(does: str) -> None:
    assert TEXTS["en"][f"pair.{does}"] == DOES[does]
    for texts in TEXTS.values():
        assert {key for key in texts if key.startswith("pair.")} == {f"pair.{one}" for one in DOES}


def test_a_robot_that_was_not_heard_of_is_silent() -> None:
    assert RobotView(1).does("", "", True, RobotView(2)) == "silent"
