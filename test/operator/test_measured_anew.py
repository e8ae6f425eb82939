"""What the page says of a door that a gauge measured in part, or more than once."""

from __future__ import annotations

from math import nan
from pathlib import Path

import pytest

from doormill_interfaces.msg import DoorInspection, FeatureDeviation, MilledDoor, RunResult
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.operator.history.history import load_history
from doormill_ros.operator.history.run_book import RunBook
from doormill_ros.operator.views.door_view import door_view
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.view_store import ViewStore
from doormill_ros.recipes.documents import load_recipe

GOOD, BAD = MeasuredDoor("hinge_1", 1e-4, 5e-4), MeasuredDoor("hinge_1", 9e-4, 5e-4)
RUN = EndedRun("r1", "oak", True, 0, "door oak milled: 9 targets; not measured", 1.0)


class Page(OperatorPage):
    """The page's callbacks without a node."""

    def __init__(self, folder: Path) -> None:
        self.store = ViewStore()
        self._runs = RunBook(self.store, folder)


@pytest.fixture
def page(tmp_path: Path) -> Page:
    return Page(tmp_path)


def gauged(run_id: str, seconds: int, **deviations: list[float]) -> DoorInspection:
    message = DoorInspection(run_id=run_id)
    message.header.stamp.sec = seconds
    for feature, sizes in deviations.items():
        message.feature = [*message.feature, *[feature] * len(sizes)]
        message.deviation = [*message.deviation, *sizes]
    return message


def ended(run_id: str) -> RunResult:
    return RunResult(
        run_id=run_id, door_id="oak", success=True, message="door oak milled: 9 targets; not measured"
    )


def test_a_feature_of_which_a_point_has_no_number_is_not_measured(page: Page) -> None:
    recipe = load_recipe("standard_door")
    first, second, third = [feature.id for feature in recipe.features][:3]
    page.store.update(lambda v: v.with_run("r1", "oak").with_drawing(door_view(recipe, "r1")))
    page._take_result(ended("r1"))
    page._take_inspection(gauged("r1", 1, **{first: [1e-4], second: [2e-4, nan, 1e-4], third: [nan]}))
    drawn = page.store.view.document()["drawing"]["features"]
    shown = {one["name"]: (one["came_to"], one["deviation"]) for one in drawn}
    assert shown[first] == ("within", 1e-4)
    assert {shown[second][0], shown[third][0]} == {"not_measured"}
    assert max(shown[second][1], shown[third][1]) < 0.0
    page._take_inspection(gauged("r1", 2, **{second: [2e-4], first: [nan]}))
    drawn = page.store.view.document()["drawing"]["features"]
    shown = {one["name"]: one["came_to"] for one in drawn}
    assert (shown[first], shown[second]) == ("not_measured", "within")


def test_a_later_gauge_counts_before_an_earlier_one() -> None:
    good = RUN.found(GOOD, 10.0)
    bad = good.found(BAD, 20.0)
    assert (bad.success, bad.error_code, bad.outcome) == (
        False,
        OutOfToleranceError.code,
        "milled, out of tolerance",
    )
    assert "0.90 mm off" in bad.message
    assert "0.10" not in bad.message
    again = bad.found(GOOD, 30.0)
    assert (again.success, again.error_code, again.outcome) == (True, 0, "milled")
    assert again.message == f"door oak milled: measured anew; {GOOD.sentence}"
    assert good.found(MeasuredDoor("hinge_2", 2e-4, 5e-4), 10.0).message == (
        "door oak milled: 9 targets; hinge_2 is 0.20 mm off where 0.50 mm are allowed"
    )
    assert (
        bad.found(GOOD, 19.0) == bad
    )  # as what was handed in, and is told again to a page that starts later
    refused = EndedRun("r1", "oak", False, 204, "no edge", 1.0)
    assert refused.found(GOOD, 10.0) == refused


def test_what_was_measured_in_the_cell_counts_before_every_gauge(page: Page, tmp_path: Path) -> None:
    milled = MilledDoor(run_id="r1", tolerance=5e-4)
    milled.features = [FeatureDeviation(feature="hinge_1", corrected_max=1e-4)]
    page._take_milled(milled)
    page._take_result(ended("r1"))
    page._take_milled(MilledDoor(run_id="r2", tolerance=5e-4, features=milled.features))
    page._take_result(ended("r2"))
    before = page.store.view.history
    assert all(run.measured for run in before)
    page._take_inspection(gauged("r1", 50, hinge_1=[9e-4]))
    assert page.store.view.history == before
    later = Page(tmp_path)
    later._take_inspection(gauged("r1", 60, hinge_1=[9e-4]))
    assert set(later.store.view.history) == set(before)


def test_the_history_says_what_the_last_gauge_found(page: Page, tmp_path: Path) -> None:
    page._take_result(ended("r1"))
    page._take_inspection(gauged("r1", 10, hinge_1=[1e-4]))
    page._take_inspection(gauged("r1", 20, hinge_1=[-9e-4]))
    (run,) = page.store.view.history
    assert "0.90 mm off" in run.message
    assert load_history(tmp_path) == (run,)
