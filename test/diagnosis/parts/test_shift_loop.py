"""The next doors of a shift, milled and gauged: what the loop is worth, and that a wrong model shows as worse."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from doormill_ros.diagnosis.parts.correction.model import door_model_document
from doormill_ros.pipeline.plan import MillingSetup
from support.gauged_shift import HINGE_DOORS
from support.shift_loop import LoopWorth, loop_worth, untroubled
from support.shift_worlds import DrawnShift, diagnosed

SEED, COUNT = 11, 5
DOORS = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), COUNT))


def shift(factor: float) -> DrawnShift:
    return DrawnShift({"seed": SEED, "force": {"factor": factor}}, (), DOORS)


@pytest.fixture(scope="module")
def untroubled_setup(tmp_path_factory: pytest.TempPathFactory) -> MillingSetup:
    """Of a shift in which all is as assumed."""
    return untroubled(tmp_path_factory.mktemp("untroubled"))


@pytest.fixture(scope="module")
def worth(tmp_path_factory: pytest.TempPathFactory, untroubled_setup: MillingSetup) -> dict[str, LoopWorth]:
    """Of a force that is smaller than assumed: with what its own doors tell, and with what doors of a larger one do."""
    folder: Path = tmp_path_factory.mktemp("shift-loop")
    own = diagnosed(folder / "own", shift(0.7), SEED)
    other = diagnosed(folder / "other", shift(1.4), SEED)
    return {
        name: loop_worth(folder / "own", diagnosis, COUNT, SEED, untroubled_setup)
        for name, diagnosis in (("own", own), ("other", other))
    }


def test_what_the_doors_tell_leaves_what_gauge_and_program_leave(worth: dict[str, LoopWorth]) -> None:
    assert worth["own"].kept
    assert not worth["own"].worse
    assert worth["own"].after < 0.7 * worth["own"].before


def test_what_other_doors_tell_is_worse_than_nothing(worth: dict[str, LoopWorth]) -> None:
    assert worth["other"].worse
    assert not worth["other"].kept
    assert worth["other"].least == worth["own"].least
    assert worth["other"].before == worth["own"].before


def test_a_refused_door_is_neither_kept_nor_worse() -> None:
    refused = LoopWorth(1e-5, 1e-4, float("nan"))
    assert not refused.kept
    assert not refused.worse


def test_a_mill_that_wears_is_told_as_it_will_be_at_the_next_door(
    tmp_path: Path, untroubled_setup: MillingSetup
) -> None:
    wear = 0.08
    worn = DrawnShift({"seed": SEED, "force": {"wear_per_door": wear}}, (), DOORS)
    diagnosis = diagnosed(tmp_path / "worn", worn, SEED)
    (cause,) = door_model_document(diagnosis, "a shift")["causes"]
    assert cause["parameters"]["factor"] == pytest.approx(1.0 + wear * COUNT, abs=0.02)
    assert diagnosis.findings[0].values[0] == pytest.approx(1.0 + wear * (COUNT - 1), abs=0.02)
    assert loop_worth(tmp_path / "worn", diagnosis, COUNT, SEED, untroubled_setup).kept
