"""The door as the page draws it: where its features lie, when they are milled and how they came out."""

from __future__ import annotations

import json
import re
import time
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from playwright.sync_api import Page, expect

from doormill_ros.operator.languages import LANGUAGES
from doormill_ros.operator.views.door_view import door_view, planned_times
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.state import CellView
from doormill_ros.operator.views.view_store import ViewStore
from doormill_ros.recipes.documents import load_recipe, shipped_recipes

CAME_TO = {
    "planned",
    "in_work",
    "within",
    "beyond",
    "measured",
    "milled",
    "half_milled",
    "not_measured",
    "not_milled",
}
FACES = {"front", "hinge_edge", "lock_edge"}


def ended(run_id: str, success: bool) -> EndedRun:
    return EndedRun(run_id, "door", success, 0 if success else 491, "", 1.0)


@pytest.mark.parametrize("name", sorted(shipped_recipes()))
def test_every_feature_lies_where_its_recipe_has_it(name: str) -> None:
    """Middle of the outline, against the feature's frame in the door, and inside of the face."""
    recipe = load_recipe(name)
    drawn = door_view(recipe, "r1")
    assert [feature.name for feature in drawn.features] == [feature.id for feature in recipe.features]
    for feature, shown in zip(recipe.features, drawn.features, strict=True):
        x, y, z = 1e3 * recipe.T_door_feature(feature)[:3, 3]
        across = {"front": y, "hinge_edge": drawn.thickness - x, "lock_edge": x}[shown.face]
        points = np.array(shown.outline)
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        np.testing.assert_allclose(middle, [across, z], atol=0.11)
        most = drawn.width if shown.face == "front" else drawn.thickness
        # A hinge is open towards the edge it lies at.
        assert points[:, 0].max() > 0.0
        assert points[:, 0].min() < most
        assert points[:, 1].min() >= 0.0
        assert points[:, 1].max() <= drawn.height


def states(view: CellView) -> set[str]:
    drawn = view.document()["drawing"]
    assert drawn is not None
    return {feature["came_to"] for feature in drawn["features"]}


def test_what_came_of_the_features_follows_the_run() -> None:
    recipe = load_recipe("standard_door")
    names = [feature.id for feature in recipe.features]
    view = CellView().with_run("r1", recipe.door_id).with_drawing(door_view(recipe, "r1"))
    assert states(view) == {"planned"}
    milling = view.with_stage("milling", 0.7)
    assert states(milling) == {"in_work"}
    assert states(milling.with_ended(ended("r1", False))) == {"not_milled"}
    milled = milling.with_ended(ended("r1", True))
    assert states(milled) == {"milled"}
    measured = milled.with_measured("r1", dict.fromkeys(names, 2e-4) | {names[0]: 6e-4}, 5e-4)
    assert states(measured) == {"within", "beyond"}
    assert states(milled.with_measured("r1", dict.fromkeys(names, 2e-4), 0.0)) == {"measured"}


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_state_and_face_has_its_words(code: str) -> None:
    texts = json.loads(
        (files("doormill_ros.operator") / f"browser/texts/{code}.json").read_text(encoding="utf-8")
    )
    assert {key for key in texts if key.startswith("came.")} == {f"came.{state}" for state in CAME_TO}
    assert {key for key in texts if key.startswith("face.")} == {f"face.{face}" for face in FACES}


def test_another_runs_figures_are_passed_over() -> None:
    recipe = load_recipe("standard_door")
    view = CellView().with_run("r1", recipe.door_id).with_drawing(door_view(recipe, "r1"))
    hinge = recipe.features[0].id
    assert view.with_measured("r0", {hinge: 1e-3}, 5e-4) == view
    assert view.with_plan("r0", {hinge: (1.0, 2.0)}) == view
    planned = view.with_plan("r1", {hinge: (1.0, 2.0), "no such": (2.0, 3.0)})
    assert planned.with_drawing(door_view(recipe, "r1")) == planned
    assert planned.with_drawing(door_view(recipe, "r2")).drawing == door_view(recipe, "r2")


@given(
    st.lists(
        st.tuples(st.floats(0.01, 1.0), st.floats(0.01, 1.0), st.sampled_from(["", "a", "b"])), min_size=2
    ),
    st.floats(1.0, 500.0),
)
def test_planned_times_follow_ways_and_feeds(motions: list[tuple[float, float, str]], total: float) -> None:
    """Straight on along x: the times are those of length over speed, and the last motion ends with the program."""
    ways, speeds, names = (list(column) for column in zip(*motions, strict=True))
    places = np.column_stack([np.cumsum(ways), np.zeros(len(ways)), np.zeros(len(ways))])
    times = planned_times(places, range(len(ways)), np.array(speeds), names, total)
    each = [0.0] + [way / speed for way, speed in zip(ways[1:], speeds[1:], strict=True)]
    clock = np.concatenate([[0.0], np.cumsum(each)]) * total / sum(each)
    assert times.keys() == set(names) - {""}
    for name, (begin, end) in times.items():
        mine = [i for i, other in enumerate(names) if other == name]
        assert begin == pytest.approx(clock[mine[0]], rel=1e-9, abs=1e-9)
        assert end == pytest.approx(clock[mine[-1] + 1], rel=1e-9, abs=1e-9)


def test_the_page_draws_the_door_and_lists_its_errors(shown: tuple[ViewStore, Page, list[str]]) -> None:
    served, page, errors = shown
    recipe = load_recipe("standard_door")
    names = [feature.id for feature in recipe.features]
    store = served.store
    store.update(lambda v: v.with_run("r1", recipe.door_id).with_drawing(door_view(recipe, "r1")))
    page.wait_for_selector("#drawing polygon.planned", state="attached")
    assert page.locator("#drawing polygon").count() == len(names)
    plan = {name: (0.0, 1e-3) if number == 0 else (0.0, 1e6) for number, name in enumerate(names)}
    store.update(lambda v: v.with_plan("r1", plan).with_stage("milling", 0.7))
    page.wait_for_selector("#drawing polygon.in_work", state="attached")
    page.wait_for_selector("#drawing polygon.milled", state="attached")
    assert page.locator("#drawing polygon.milled").count() == 1
    off = dict.fromkeys(names, 2e-4) | {names[1]: 6e-4}
    store.update(lambda v: v.with_ended(ended("r1", False)).with_measured("r1", off, 5e-4))
    page.wait_for_selector("#drawing polygon.beyond", state="attached")
    row = page.locator("#drawing-features tr.beyond")
    assert row.locator("td").all_text_contents() == [names[1], "out of tolerance", "0.60 mm", "0.50 mm"]
    assert errors == []


def test_a_waiting_door_shows_for_how_long(shown: tuple[ViewStore, Page, list[str]]) -> None:
    served, page, _ = shown
    since = time.time() - 125.0
    served.store.update(lambda v: v.with_handshake("requested", "waits for the targets", since=since))
    # Not by wait_for_function: a text that it has to evaluate again is what the page forbids.
    expect(page.locator("#since")).to_contain_text(" min ")
    said = re.fullmatch(r"(\d+) min (\d+) s", page.locator("#since").text_content() or "")
    assert said is not None
    assert 125 <= 60 * int(said[1]) + int(said[2]) <= time.time() - since + 1
