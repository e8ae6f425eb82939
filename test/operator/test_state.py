"""The view follows the cell, in whatever order its messages come."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.operator.views.advice import next_step
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.short_text import LONGEST_TEXT
from doormill_ros.operator.views.state import HISTORY, CellView
from doormill_ros.operator.views.view_store import ViewStore

STATES = [state.value for state in HandshakeState]


def ended(run_id: str, success: bool = True, message: str = "", ended: float = 1.0) -> EndedRun:
    return EndedRun(run_id, "door", success, 0 if success else 204, message, ended)


def test_a_view_cannot_be_changed() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        CellView().state = "ready"


def test_a_good_run_from_start_to_end() -> None:
    view = CellView().with_handshake("requested", "").with_run("r1", "oak")
    view = view.with_stage("milling", 0.7)
    assert view.document() | {"door_id": "oak", "stage": "milling", "progress": 0.7} == view.document()
    view = view.with_ended(ended("r1"))
    assert (view.run_id, view.door_id, view.stage, view.refusal) == ("", "", "", "")
    assert view.document()["history"][0]["run_id"] == "r1"


@pytest.mark.parametrize("code", [0, 450])
@pytest.mark.parametrize("state", ["ready", "acknowledged", "milling"])
def test_a_link_that_is_cleared_does_not_hide_that_the_robot_may_move(state: str, code: int) -> None:
    """The bridge clears the link after the handover, while the robot mills, and for as long as the link is broken."""
    view = CellView().with_run("r1", "oak").with_handshake(state, "", "r1", "oak")
    view = view.with_handshake("clearing", "file handed over", "r1", "oak", error_code=code)
    for seen in (
        view,
        view.with_ended(ended("r1", False, "no link")),
        view.with_fault("abb_bridge", "no link"),
    ):
        document = seen.document()
        assert (document["state"], document["situation"]["key"]) == ("clearing", "may_move")
        assert (document["urgency"], document["step"]["key"]) == ("danger", "about_to_move")
    # A page that is started meanwhile hears of that state alone.
    late = CellView().with_run("r1", "oak").with_handshake("clearing", "file handed over", "r1", "oak")
    assert late.document()["urgency"] == "danger"
    over = view.with_handshake("milling", "", "r1", "oak").with_handshake("failed", "a fault", "r1", "oak")
    assert over.with_handshake("clearing", "no link", error_code=450).document()["step"]["key"] == "clearing"
    early = CellView().with_run("r1", "oak").with_handshake("clearing", "no link", error_code=450)
    assert (early.document()["situation"]["key"], early.document()["urgency"]) == ("clearing", "wait")


def test_the_reason_of_a_refusal_stays_until_the_next_run() -> None:
    view = CellView().with_run("r1", "oak").with_refused_picture("r1", "no edge")
    assert view.refusal == "no edge"
    view = view.with_ended(ended("r1", False, "door oak: no edge"))
    assert view.refusal == "door oak: no edge"
    assert view.with_run("r2", "oak").refusal == ""
    assert view.with_ended(ended("r2")).refusal == ""


def test_a_second_picture_that_is_good_takes_the_refusal_back() -> None:
    view = CellView().with_run("r1", "oak").with_refused_picture("r1", "no edge")
    assert view.with_found_door("r0").refusal == "no edge"
    assert view.with_found_door("r1").refusal == ""


def test_latched_messages_may_come_in_any_order() -> None:
    """A page started late gets the last recipe and the last result, which are of one run that is over."""
    result_first = CellView().with_ended(ended("r1")).with_run("r1", "oak")
    recipe_first = CellView().with_run("r1", "oak").with_ended(ended("r1"))
    assert result_first.run_id == recipe_first.run_id == ""


def test_another_runs_messages_do_not_touch_the_run_in_hand() -> None:
    view = CellView().with_run("r2", "oak").with_stage("pose", 0.3)
    for own in ("", "no picture"):
        before = view.with_refused_picture("r2", own, 301 if own else 0).with_notice("wait", 7)
        for end in (ended("r1"), ended("r1", False, "door elm: no edge")):
            later = before.with_ended(end).with_refused_picture("r1", "no edge")
            assert later == dataclasses.replace(before, history=(end,))


def test_a_run_counts_once_and_the_newest_is_first() -> None:
    view = CellView()
    for number in [*range(HISTORY + 5), HISTORY + 4]:
        view = view.with_ended(ended(f"r{number}"))
    assert [run.run_id for run in view.history] == [f"r{n}" for n in range(HISTORY + 4, 4, -1)]


def test_long_texts_are_cut() -> None:
    view = CellView().with_ended(ended("r1", False, "x" * 10 * LONGEST_TEXT))
    assert len(view.refusal) == LONGEST_TEXT


def test_a_new_picture_has_a_new_number() -> None:
    view = CellView().with_picture(b"1", "image/jpeg", "one").with_picture(b"2", "image/jpeg", "two")
    shown = view.document()["picture"]
    assert (shown["number"], shown["caption"]) == (2, "two")


def test_faults_come_and_go() -> None:
    view = CellView().with_handshake("idle", "").with_fault("door_localizer", "no camera.yaml")
    assert view.document()["urgency"] == "fault"
    assert "no camera.yaml" in view.document()["next_step"]
    view = view.with_fault("door_localizer", "")
    assert view.faults == {}
    assert view.document()["urgency"] == "act"


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("in_hand", [False, True])
def test_every_state_of_the_handshake_has_a_next_step(state: str, in_hand: bool) -> None:
    step = next_step(True, state, in_hand, "", {})
    assert step.urgency in ("wait", "act", "danger")
    assert step.text.endswith(".")


@pytest.mark.parametrize("state", ["ready", "acknowledged", "milling"])
@pytest.mark.parametrize("in_hand", [False, True])
def test_nothing_hides_that_the_robot_may_move(state: str, in_hand: bool) -> None:
    step = next_step(True, state, in_hand, "refused", {"path_generator": "broken"})
    assert step.urgency == "danger"
    assert "Stay out" in step.text


@pytest.mark.parametrize("state", STATES)
def test_a_silent_bridge_is_never_shown_as_an_old_state(state: str) -> None:
    view = CellView().with_handshake(state, "").with_bridge(False)
    document = view.document()
    assert document["state"] == ""
    assert "/abb_bridge" in document["next_step"]
    assert "Stay out" in document["next_step"]
    assert view.with_bridge(True).document()["state"] == state


_RUNS = st.sampled_from(["r1", "r2", "r3"])
_CHANGES = st.one_of(
    st.tuples(st.just("with_handshake"), st.sampled_from(STATES), st.text()),
    st.tuples(st.just("with_run"), _RUNS, st.text()),
    st.tuples(st.just("with_stage"), st.text(), st.floats(0, 1)),
    st.tuples(st.just("with_refused_picture"), _RUNS, st.text()),
    st.tuples(st.just("with_found_door"), _RUNS),
    st.tuples(st.just("with_ended"), st.builds(ended, _RUNS, st.booleans(), st.text())),
    st.tuples(st.just("with_fault"), st.text(), st.text()),
    st.tuples(st.just("with_bridge"), st.booleans()),
)


@given(st.lists(_CHANGES, max_size=20))
def test_any_order_of_messages_gives_a_page(changes: list[tuple[Any, ...]]) -> None:
    view = CellView()
    for name, *arguments in changes:
        view = getattr(view, name)(*arguments)
    document = json.loads(json.dumps(view.document()))
    assert document["next_step"]
    over = {run["run_id"] for run in document["history"]}
    assert document["run_id"] not in over
    assert len(over) == len(document["history"])


def test_a_listener_hears_of_changes_only_and_not_after_its_end() -> None:
    store, heard = ViewStore(), []
    end = store.listen(lambda: heard.append(store.view.state))
    store.update(lambda view: view.with_handshake("idle", ""))
    store.update(lambda view: view.with_handshake("idle", ""))
    end()
    store.update(lambda view: view.with_handshake("requested", ""))
    assert heard == ["idle"]


def test_a_spoiled_door_is_not_said_to_be_milled_well() -> None:
    view = CellView().with_handshake("done", "").with_run("r1", "oak")
    spoiled = EndedRun("r1", "oak", False, OutOfToleranceError.code, "1.60 mm off", 1.0, True)
    document = view.with_ended(spoiled).document()
    assert document["history"][0]["outcome"] == "milled, out of tolerance"
    assert "out of tolerance" in document["next_step"]
    assert document["refusal"] == "1.60 mm off"


@pytest.mark.parametrize(
    ("run", "words"),
    [
        (EndedRun("r", "oak", True, 0, "", 1.0, True), "milled"),
        (EndedRun("r", "oak", True, 0, "", 1.0, False), "milled, not measured"),
        (EndedRun("r", "oak", False, 204, "", 1.0), "refused (204)"),
    ],
)
def test_the_history_says_what_is_known_of_a_door(run: EndedRun, words: str) -> None:
    assert CellView().with_ended(run).document()["history"][0]["outcome"] == words


DONE = "the robot reported the end of milling"


@pytest.mark.parametrize(("state", "reason"), [("done", DONE), ("failed", "oak: no edge")])
@pytest.mark.parametrize("request_high", [False, True])
def test_a_started_door_is_not_told_how_the_door_before_ended(
    state: str, reason: str, request_high: bool
) -> None:
    view = CellView().with_run("r1", "oak").with_handshake(state, reason, "r1", "oak", request_high)
    assert (view.document()["state"], view.document()["state_reason"]) == (state, reason)
    document = view.with_ended(ended("r1", state == "done", reason)).with_run("r2", "elm").document()
    assert document["state"] == ("requested" if request_high else "idle")
    assert document["state_reason"].startswith("door elm ")
    assert reason not in document["state_reason"]
    assert "closed" not in document["next_step"]
    assert document["next_step"] == next_step(True, document["state"], True, "", {}).text
    # Its own end is told as such.
    own = view.with_ended(ended("r1")).with_run("r2", "elm").with_handshake(state, reason, "r2", "elm")
    assert own.document()["state"] == state


def test_a_waiting_door_shows_how_long_it_waits_not_how_long_ago_another_was_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = 1.8e9
    monkeypatch.setattr("doormill_ros.operator.views.moments.time.time", lambda: now)
    monkeypatch.setattr("doormill_ros.operator.views.moments.time.monotonic", lambda: 100.0)
    view = CellView().with_run("r1", "oak", now - 900.0)
    view = view.with_handshake("done", DONE, "r1", "oak", since=now - 600.0)
    assert view.document()["state_age"] == 600.0
    view = view.with_ended(ended("r1"))
    assert view.document()["state_age"] == 600.0
    waiting = view.with_run("r2", "elm", now - 200.0)
    assert waiting.document()["state_age"] == 200.0
    assert waiting.with_ended(ended("r2", False, "canceled")).document()["state_age"] is None
    assert view.with_run("r2", "elm").document()["state_age"] is None


@pytest.mark.parametrize("step", [3600.0, -3600.0])
def test_the_age_of_a_state_goes_on_when_the_wall_clock_is_set(
    step: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    wall, steady = [1.8e9], [100.0]
    monkeypatch.setattr("doormill_ros.operator.views.moments.time.time", lambda: wall[0])
    monkeypatch.setattr("doormill_ros.operator.views.moments.time.monotonic", lambda: steady[0])
    view = CellView().with_handshake("idle", "", since=wall[0] - 600.0)
    wall[0] += step + 5.0
    steady[0] += 5.0
    assert view.document()["state_age"] == 605.0
    ahead = CellView().with_handshake("idle", "", since=wall[0] + 60.0)  # told by a clock that is ahead
    assert ahead.document()["state_age"] == 0.0


def test_a_door_refused_before_it_was_asked_for_is_not_said_to_be_milled() -> None:
    view = CellView().with_run("r1", "oak").with_handshake("done", DONE, "r1", "oak").with_ended(ended("r1"))
    document = view.with_run("r2", "elm").with_ended(ended("r2", False, "canceled")).document()
    assert "not milled" in document["next_step"]
    assert (document["state"], DONE in document["state_reason"]) == ("idle", False)


def test_a_run_given_up_that_the_robot_milled_on_is_not_said_to_be_unmilled() -> None:
    view = CellView().with_run("r1", "oak").with_handshake("milling", "", "r1", "oak")
    view = view.with_ended(ended("r1", False, "canceled")).with_handshake("done", DONE, "r1", "oak")
    document = view.document()
    assert (document["state"], document["state_reason"]) == ("done", DONE)
    assert "not milled" not in document["next_step"]
    assert "look at the door" in document["next_step"]


DOORS = {"r1": "oak", "r2": "elm", "r3": "ash"}
_RUNS_AND_DOORS = st.sampled_from(sorted(DOORS.items()))
_OF_DOORS = st.one_of(
    st.builds(lambda run: ("with_run", *run), _RUNS_AND_DOORS),
    st.builds(
        lambda run, state, request: ("with_handshake", state, f"told of {run[1]}", *run, request),
        _RUNS_AND_DOORS,
        st.sampled_from(STATES),
        st.booleans(),
    ),
    st.builds(
        lambda run, code: ("with_ended", EndedRun(*run, not code, code, "why" if code else "", 1.0)),
        _RUNS_AND_DOORS,
        st.sampled_from([0, 204, OutOfToleranceError.code]),
    ),
)


@given(st.lists(_OF_DOORS, max_size=20))
def test_state_and_next_step_are_of_one_door(changes: list[tuple[Any, ...]]) -> None:
    view = CellView()
    for name, *arguments in changes:
        view = getattr(view, name)(*arguments)
    view = view.with_bridge(True)
    document, key = view.document(), view.document()["step"]["key"]
    last = view.run_id or (view.history[0].run_id if view.history else view.state_run)
    if document["state"] in ("done", "failed"):
        assert view.state_run == last
    assert not (document["state"] == "done" and key == "not_milled")
    if key in ("not_milled", "spoiled", "milled_after_all", "done"):
        assert document["next_step"].count(DOORS[last]) == 1
        assert not view.run_id
    if document["situation"]["ended"]:
        before = DOORS[view.state_run]
        assert f"the door before, {before}, " in document["state_reason"]
        assert before not in document["next_step"]


@pytest.mark.parametrize(("state", "words"), [("done", "was milled"), ("failed", "came to nothing")])
def test_a_door_refused_before_it_was_asked_for_is_told_apart_from_the_one_before(
    state: str, words: str
) -> None:
    view = CellView().with_run("r1", "oak").with_handshake(state, "told of oak", "r1", "oak", error_code=450)
    view = view.with_ended(EndedRun("r1", "oak", state == "done", 0 if state == "done" else 450, "", 1.0))
    document = view.with_run("r2", "elm").with_ended(EndedRun("r2", "elm", False, 204, "no", 2.0)).document()
    assert (document["state"], document["state_code"]) == ("idle", 0)
    assert document["state_reason"] == f"the controller asks for nothing; the door before, oak, {words}"
    assert document["next_step"].startswith("The door elm was not milled.")


def test_a_door_whose_name_nobody_told_has_none_in_the_next_step() -> None:
    assert CellView().with_handshake("done", "").document()["next_step"].startswith("The door is milled.")
