"""What the operator's page keeps of the codes that nodes give beside their words."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image

from doormill_interfaces.msg import (
    AbbStatus,
    DoorInspection,
    DoorLocalization,
    DoorRecipe,
    FeatureDeviation,
    MilledDoor,
    RunResult,
)
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.operator.history.history import FILE, kept_run, load_history
from doormill_ros.operator.views.fault import Fault
from doormill_ros.operator.views.state import HISTORY

BEYOND = "milled, out of tolerance"


def diagnosis(
    values: dict[str, str], level: bytes = DiagnosticStatus.ERROR, name: str = "cell1/gige_camera"
) -> DiagnosticArray:
    pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
    return DiagnosticArray(
        status=[DiagnosticStatus(level=level, name=name, message="no answer", values=pairs)]
    )


@pytest.fixture(params=[1])
def page(context: rclpy.Context, tmp_path: Path, request: pytest.FixtureRequest):
    parameters = [Parameter("port", value=0), Parameter("robots", value=request.param)]
    parameters += [Parameter(name, value=str(tmp_path / name)) for name in ("history", "audit")]
    node = OperatorPage(parameter_overrides=parameters, context=context, namespace="cell1")
    node.bring_up()
    yield node
    node.close()
    node.destroy_node()


def test_codes_come_with_faults_refusals_and_states(page: OperatorPage) -> None:
    for values, code in (
        ({"lost": "3", "error_code": "242"}, 242),
        ({"lost": "3"}, 0),
        ({"error_code": "none"}, 0),
        ({"error_code": "9" * 5000}, 0),
    ):
        page._take_diagnostics(diagnosis(values))
        assert page.store.view.faults == {"cell1/gige_camera": Fault("no answer", code)}
    page._take_diagnostics(diagnosis({}, DiagnosticStatus.OK))
    assert page.store.view.faults == {}
    page._take_recipe(DoorRecipe(run_id="r1", door_id="oak"))
    page._take_localization(DoorLocalization(run_id="r1", door_id="oak", error_code=207, reason="dark"))
    assert (page.store.view.refusal, page.store.view.refusal_code) == ("dark", 207)
    page._take_status(AbbStatus(state="clearing", reason="no link", error_code=450))
    assert page.store.view.state_code == 450


def gauged(run_id: str, deviation: float) -> DoorInspection:
    return DoorInspection(
        run_id=run_id, feature=["lock_case", "hinge_1"], wall=[False, True], deviation=[1e-5, deviation]
    )


@pytest.mark.parametrize("late", [False, True], ids=["before the result", "after it"])
@pytest.mark.parametrize(("deviation", "outcome", "code"), [(-1.6e-3, BEYOND, 807), (4e-4, "milled", 0)])
def test_a_gauge_says_how_an_ended_run_came_out(
    page: OperatorPage, tmp_path: Path, late: bool, deviation: float, outcome: str, code: int
) -> None:
    result = RunResult(
        run_id="r1", door_id="oak", success=True, message="door oak milled: 4 targets; not measured"
    )
    heard = [partial(page._take_result, result), partial(page._take_inspection, gauged("r1", deviation))]
    for hear in heard if late else reversed(heard):
        hear()
    (run,) = page.store.view.history
    assert (run.outcome, run.success, run.error_code, run.measured) == (outcome, code == 0, code, True)
    assert f"hinge_1 is {abs(deviation) * 1e3:.2f} mm off where 0.50 mm are allowed" in run.message
    assert "not measured" not in run.message
    assert (page.store.view.refusal, page.store.view.refusal_code) == ("" if code == 0 else run.message, code)
    assert load_history(tmp_path / "history") == (run,)
    page._take_inspection(gauged("r1", 5e-3))  # measured again: what was found last is what the run came to
    (again,) = page.store.view.history
    assert (again.error_code, "hinge_1 is 5.00 mm off" in again.message) == (807, True)
    page._take_result(result)
    assert page.store.view.history == (again,)
    assert load_history(tmp_path / "history") == (again,)


@pytest.mark.parametrize("turn", [1, -1], ids=["first", "last"])
def test_who_measures_in_the_cell_is_believed(page: OperatorPage, turn: int) -> None:
    feature = FeatureDeviation(feature="hinge_1", corrected_max=1e-4)
    milled = MilledDoor(run_id="r1", tolerance=5e-4, features=[feature])
    heard = [partial(page._take_milled, milled), partial(page._take_inspection, gauged("r1", 1.6e-3))]
    for hear in heard[::turn]:
        hear()
    page._take_result(RunResult(run_id="r1", door_id="oak", success=True, message="door oak"))
    (run,) = page.store.view.history
    assert run.outcome == "milled"
    assert "hinge_1 is 0.10 mm off" in run.message


def test_who_measures_in_the_cell_may_take_longer_than_the_run_waits(
    page: OperatorPage, tmp_path: Path
) -> None:
    page._take_result(RunResult(run_id="r1", door_id="oak", success=True, message="door oak"))
    feature = FeatureDeviation(feature="hinge_1", corrected_max=2e-3)
    page._take_milled(MilledDoor(run_id="r1", tolerance=5e-4, features=[feature]))
    (run,) = page.store.view.history
    assert (run.outcome, run.error_code) == (BEYOND, 807)
    assert load_history(tmp_path / "history") == (run,)


def test_a_run_that_is_shown_no_more_is_amended_where_it_is_kept(page: OperatorPage, tmp_path: Path) -> None:
    """A gauge by hand comes to a door an hour after it was milled."""
    for number in range(HISTORY + 1):
        page._take_result(RunResult(run_id=f"r{number}", door_id="oak", success=True, message="not measured"))
    shown = page.store.view.history
    assert "r0" not in {run.run_id for run in shown}
    for _ in range(2):
        page._take_inspection(gauged("r0", 1.6e-3))
    page._take_inspection(gauged("nobody's", 1.6e-3))
    assert page.store.view.history == shown
    first = kept_run(tmp_path / "history", "r0")
    assert first is not None
    assert (first.outcome, first.error_code) == (BEYOND, 807)
    assert kept_run(tmp_path / "history", "nobody's") is None
    kept = (tmp_path / "history" / FILE).read_text().splitlines()
    assert len(kept) == HISTORY + 2


def test_a_refused_run_stays_refused_whatever_a_gauge_says(page: OperatorPage) -> None:
    page._take_result(RunResult(run_id="r1", door_id="oak", error_code=204, message="too far off"))
    page._take_inspection(gauged("r1", 1.6e-3))
    (run,) = page.store.view.history
    assert (run.error_code, run.measured) == (204, False)


def test_a_door_measured_late_does_not_speak_for_the_one_in_hand(page: OperatorPage) -> None:
    page._take_result(RunResult(run_id="r1", door_id="oak", success=True, message="not measured"))
    page._take_recipe(DoorRecipe(run_id="r2", door_id="ash"))
    page._take_inspection(gauged("r1", 1.6e-3))
    assert page.store.view.refusal == ""
    assert page.store.view.history[0].outcome == BEYOND


@pytest.mark.parametrize("page", [2], indirect=True)
def test_both_robots_are_heard_each_in_its_namespace(page: OperatorPage) -> None:
    assert page.store.view.document()["step"]["key"] == "silent_both"
    own = {f"/cell1/robot{n}/{name}" for n in (1, 2) for name in ("abb/status", "path/targets")}
    heard = {subscription.topic_name for subscription in page.subscriptions}
    assert own <= heard
    assert not {"/cell1/abb/status", "/cell1/path/targets"} & heard
    for number, state in ((1, "milling"), (2, "requested")):
        page._take_diagnostics(diagnosis({}, DiagnosticStatus.OK, f"cell1/robot{number}/abb_bridge"))
        page._take_status(AbbStatus(state=state, run_id="r1", request=number == 2), robot=number)
    view = page.store.view.document()
    assert [robot["present"] for robot in view["robots"]] == [True, True]
    assert view["state_reason"] == "robot 1 mills; the controller of robot 2 asks for targets"
    for name in ("robot1/abb_bridge", "cell2/robot1/abb_bridge", "cell1/robot3/abb_bridge"):
        page._take_diagnostics(diagnosis({}, name=name))
    assert page.store.view.faults == {}
    page._take_diagnostics(diagnosis({"error_code": "450"}, name="cell1/robot2/abb_bridge/controller"))
    assert page.store.view.faults == {"cell1/robot2/abb_bridge/controller": Fault("no answer", 450)}


def test_a_page_of_one_robot_hears_its_own_cell_alone(page: OperatorPage) -> None:
    page._take_diagnostics(diagnosis({}, name="cell1/robot2/abb_bridge"))
    assert page.store.view.faults == {}
    assert page.store.view.pair is None


@pytest.mark.parametrize("overlay_first", [True, False])
def test_a_picture_that_cannot_be_shown_is_no_error_of_the_page(
    page: OperatorPage, overlay_first: bool
) -> None:
    taps = {tap.topic_name: tap.callback for tap in page.subscriptions}
    heard = [
        partial(taps["/cell1/door/overlay"], Image()),
        partial(taps["/cell1/door/localization"], DoorLocalization(run_id="r1", accepted=True)),
    ]
    page._take_recipe(DoorRecipe(run_id="r1", door_id="oak"))
    for hear in heard if overlay_first else reversed(heard):
        hear()
    assert page._health[:2] == (DiagnosticStatus.OK, "serving")
    assert page.store.view.picture is None
