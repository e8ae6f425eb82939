"""Forces that are other ones at every door: seen as such, and told from a force that changed."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.chance import by_chance, force_shares
from doormill_ros.diagnosis.parts.fitting.discrepancy import ForceDiscrepancy
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis, DoorProblem
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import Hidden, inspected, judged

KIND = Inspections()


def doors(count: int) -> tuple[str, ...]:
    """As many, of the hinge doors in turn."""
    return tuple(itertools.islice(itertools.cycle(HINGE_DOORS), count))


def problem(folder: Path, world: dict, count: int = 12, seed: int = 3) -> DoorProblem:
    """Doors of a world."""
    return KIND.problem(inspected(gauged_shift(folder, {"seed": seed, **world}, doors(count), seed)))


def diagnosed(folder: Path, world: dict, count: int, seed: int) -> DoorDiagnosis:
    """What is said of them."""
    return KIND.diagnose(
        inspected(gauged_shift(folder, {"seed": seed, **world}, doors(count), seed)), lambda line: None
    )


def test_the_force_of_every_door_is_told_beside_where_it_stood(tmp_path: Path) -> None:
    steps = {3: 1.3, 5: 0.8, 9: 1.1}
    change = [{"from_door": door, "force": {"factor": factor}} for door, factor in steps.items()]
    asked = problem(tmp_path, {"change": change})
    shares, variance = force_shares(asked)
    hidden = np.repeat([1.0, 1.3, 0.8, 1.1], [3, 2, 4, 3]) - 1.0
    assert np.sum((shares - hidden) ** 2 / variance) < 35.0  # chi square of 12, 1 in 1000: 32.9
    assert np.all(np.sqrt(variance) < 0.1)


@pytest.mark.parametrize("scatter", [0.08, 0.2])
def test_forces_that_scatter_are_seen_with_their_size(tmp_path: Path, scatter: float) -> None:
    asked = problem(tmp_path, {"force": {"scatter": scatter}}, count=20)
    found = by_chance(asked)
    assert isinstance(found, ForceDiscrepancy)
    springs = float(np.sqrt(np.mean(asked.case.springs() ** 2)))
    assert found.size / springs == pytest.approx(scatter, rel=0.5)  # of 16 free ones: 3 times 1 / sqrt(32)


def test_forces_as_assumed_do_not_scatter(tmp_path: Path) -> None:
    assert by_chance(problem(tmp_path, {})) is None
    assert by_chance(problem(tmp_path / "off", {"force": {"factor": 1.4}})) is None


def test_two_doors_tell_no_scatter(tmp_path: Path) -> None:
    assert by_chance(problem(tmp_path, {"force": {"scatter": 0.3}}, count=2)) is None


@pytest.mark.parametrize("seed", [3, 4])
def test_forces_by_chance_are_no_cause(tmp_path: Path, seed: int) -> None:
    # Asked without a scatter of forces they passed for a spring that changed, and for a gap that drifted.
    diagnosis = diagnosed(tmp_path, {"force": {"scatter": 0.1}}, 6, seed)
    assert (diagnosis.verdict, diagnosis.findings) == ("unexplained", ())
    assert [type(one) for one in diagnosis.problem.discrepancies] == [ForceDiscrepancy]


@pytest.mark.parametrize("seed", [2, 3])
def test_a_slip_of_the_clamp_is_named_alone_beside_forces_by_chance(tmp_path: Path, seed: int) -> None:
    # Asked without, forces or the flange were said to have changed, too.
    slip = {"shift": [0.0, 2e-4, -1e-4], "from_door": 3}
    found = judged(
        diagnosed(tmp_path, {"force": {"scatter": 0.08}, "clamp": slip}, 6, seed),
        (Hidden("clamp_shift", "clamp", 3),),
    )
    assert (found.missed, found.wrong, found.late) == ((), (), ())


@pytest.mark.parametrize("seed", [1, 2])
def test_a_force_that_changed_is_not_taken_for_chance(tmp_path: Path, seed: int) -> None:
    diagnosis = diagnosed(tmp_path, {"change": [{"from_door": 4, "force": {"factor": 1.15}}]}, 9, seed)
    found = judged(diagnosis, (Hidden("process_force", "tool", 4),))
    assert (found.verdict, found.missed, found.wrong, found.late) == ("explained", (), (), ())
