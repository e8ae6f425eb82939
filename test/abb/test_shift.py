"""Several doors in one continuous run over Robot Web Services (bench/shift.py), and its judge."""

from __future__ import annotations

from dataclasses import replace

import pytest

from doormill_ros.abb.handshake.state import HandshakeState as State
from support.shift import Shift, fault_of

DOORS = ("thesis_190_0deg", "thesis_1350_0deg")


@pytest.fixture(scope="module")
def shift(tmp_path_factory: pytest.TempPathFactory) -> Shift:
    made = Shift(tmp_path_factory.mktemp("shift"), DOORS, 3)
    made.run()
    return made


def test_every_door_is_milled_once_by_its_own_path_and_reported_as_done(shift: Shift) -> None:
    assert shift.faults == []
    assert [report.door for report in shift.reports] == [*DOORS, DOORS[0]]
    assert [report.ends for report in shift.reports] == [[State.DONE]] * 3
    assert [report.requests for report in shift.reports] == [1] * 3


def test_nothing_is_held_that_grows_from_door_to_door(shift: Shift) -> None:
    held = [report.held for report in shift.reports]
    assert held[-1].handles <= held[1].handles
    assert held[-1].threads <= held[1].threads


def test_both_ways_of_naming_a_door_were_taken(shift: Shift) -> None:
    """By bar code through the PC, and by the line control's number: both name their door for one door only."""
    assert shift.controller.program.read("expectedDoor") == ""
    assert shift.controller.cell.read("giDoorNumber") == 0.0
    assert shift.controller.program.read("doorNumbers")[:2] == list(DOORS)
    assert [line for line in shift.controller.pendant_lines if line in DOORS] == [
        r.door for r in shift.reports
    ]


@pytest.mark.parametrize(
    ("change", "found"),
    [
        ({}, ""),
        ({"ends": [State.FAILED]}, "the PC reported ['failed']"),
        ({"ends": []}, "the PC reported []"),
        ({"requests": 2}, "2 requests for one door"),
        ({"door": DOORS[1]}, "motion 0 leads to"),
        ({"ordered": []}, "0 motions were ordered"),
    ],
)
def test_the_judge_sees_what_is_wrong(shift: Shift, change: dict, found: str) -> None:
    report = replace(shift.reports[-1], **change)
    assert fault_of(report, shift.programs[report.door]).startswith(found)
    assert bool(found) == bool(fault_of(report, shift.programs[report.door]))
