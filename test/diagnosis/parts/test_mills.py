"""Two mills cut a shift: what is wrong with one of them is told of that one, what is wrong with both of the tool."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import gauged_shift
from support.shift_worlds import inspected

KIND = Inspections()
DOORS = tuple(itertools.islice(itertools.cycle(("standard_door", "thesis_190_0deg")), 6))
MILLS = ("mill_16", "mill_19")  #: of the two
OFF = 6e-5  #: of a radius or a length [m]


@pytest.fixture(scope="module")
def shift(tmp_path_factory: pytest.TempPathFactory) -> list:
    """Doors as assumed."""
    return inspected(gauged_shift(tmp_path_factory.mktemp("mills"), {"seed": 4}, DOORS, 4))


def cut_wrong(shift: list, mills: tuple[str, ...], walls: bool) -> DoorDiagnosis:
    """What is said of the same doors whose walls or floors some mills cut too deep."""
    doors = []
    for one in shift:
        points = one.door.points
        off = OFF * (np.isin(points.tool, mills) & (points.wall == walls))
        points = replace(points, deviation=points.deviation + off)
        doors.append(replace(one, door=replace(one.door, points=points)))
    return KIND.diagnose(doors, lambda line: None)


@pytest.mark.parametrize(("cause", "walls"), [("tool_radius", True), ("tool_length", False)])
@pytest.mark.parametrize("mills", [MILLS[:1], MILLS[1:], MILLS], ids=["one", "other", "both"])
def test_what_a_mill_cuts_too_deep_is_told_of_it(
    shift: list, cause: str, walls: bool, mills: tuple[str, ...]
) -> None:
    diagnosis = cut_wrong(shift, mills, walls)
    [finding] = diagnosis.findings
    assert finding.cause.key == (cause, "tool" if len(mills) == 2 else mills[0])
    assert finding.values[0] == pytest.approx(OFF, abs=5e-6)
    assert diagnosis.verdict == "explained"


def test_a_force_that_grew_in_one_mill_is_no_other_cause(shift: list, tmp_path: Path) -> None:
    grown = {"seed": 4, "force": {"factor": 1.4}}
    more = inspected(gauged_shift(tmp_path, grown, DOORS, 4))
    mixed = [two if "thesis" in one.door.recipe else one for one, two in zip(shift, more, strict=True)]
    [finding] = KIND.diagnose(mixed, lambda line: None).findings
    assert finding.cause.name == "process_force"
    assert finding.cause.where in ("mill_19", "hinge_oblong")  # which this mill cuts, and no other
    assert finding.values[0] == pytest.approx(1.4, abs=0.03)
