"""Doors that lean or give way in their clamp are no cause; a link that was run into is one from that door on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.robot.description import load_robot
from support.random_shift import random_doors, random_shift

KIND = Inspections()
COUNT, STEP = 9, 4


@pytest.fixture(scope="module")
def doors() -> tuple:
    """With hinges in places that tell one link from another."""
    return random_doors(4, COUNT)


@pytest.fixture(scope="module")
def shift(doors: tuple, tmp_path_factory: pytest.TempPathFactory) -> list:
    """Doors as assumed."""
    return random_shift(tmp_path_factory.mktemp("leaning"), {"seed": 4}, doors, 4)


@pytest.mark.parametrize("begins", [0, STEP])
def test_doors_that_lean_are_no_link(shift: list, begins: int) -> None:
    doors = []
    for number, one in enumerate(shift):
        points = one.door.points
        lean = 6e-5 * np.cross(np.eye(3)[1], points.point - one.door.T_base_door[:3, 3]) * (number >= begins)
        points = replace(points, deviation=points.deviation - np.sum(lean * points.normal, axis=1))
        doors.append(replace(one, door=replace(one.door, points=points)))
    diagnosis = KIND.diagnose(doors, lambda line: None)
    assert diagnosis.verdict in ("unexplained", "partly_explained")
    assert not [one for one in diagnosis.findings if one.cause.name != "clamp_shift"]


@pytest.mark.parametrize(("begins", "power"), [(0, 1), (0, 2), (STEP, 1)])
def test_doors_that_give_way_under_the_mill_are_no_base(shift: list, begins: int, power: int) -> None:
    doors = []
    for number, one in enumerate(shift):
        points = one.door.points
        height = points.point[:, 2] - one.door.T_base_door[2, 3]
        # Out of the plane and, a third of that, along it: the wood moves away from what pushes the tool.
        given = 4e-7 * (height**power)[:, None] * points.wrench[:, :3] * [1.0, 0.3, 0.0] * (number >= begins)
        points = replace(points, deviation=points.deviation + np.sum(given * points.normal, axis=1))
        doors.append(replace(one, door=replace(one.door, points=points)))
    diagnosis = KIND.diagnose(doors, lambda line: None)
    assert diagnosis.verdict == "unexplained"
    assert not diagnosis.findings
    assert "door_compliance" in [cause.name for cause in diagnosis.best.members]


@pytest.mark.parametrize("link", [2, 3, 4])
def test_a_link_that_was_run_into_is_off_from_that_door_on(
    shift: list, doors: tuple, tmp_path: Path, link: int
) -> None:
    bent = load_robot(load_layout().robot).dh.copy()
    off = np.array([2e-4, 0.0, 3e-4, 2e-4])  # theta, d, a, alpha
    bent[link - 1] += off
    later = random_shift(tmp_path, {"seed": 4}, doors, 4, bent)
    diagnosis = KIND.diagnose([*shift[:STEP], *later[STEP:]], lambda line: None)
    [finding] = diagnosis.findings
    keys = {finding.cause.key, *(cause.key for cause in finding.confusable)}
    assert ("link_geometry", f"link {link}") in keys
    assert finding.cause.course.at == diagnosis.problem.doors[STEP].time
