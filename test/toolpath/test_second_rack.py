"""The rack of a second robot: a share of two tools is milled with it, and it is in nobody's way."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.pair import Milled, judge_pair
from doormill_ros.toolpath import errors
from doormill_ros.toolpath.program import RACK_KINDS, MotionKind
from support.file_run import run_file
from support.judged_doors import RUN_ID, rigid
from support.two_tools import face_plate_door

DOOR, SETUP = face_plate_door(), rigid(load_setup())
T_CELL_DOOR = SETUP.layout.T_base_door(DOOR.width, DOOR.thickness)
T_FIRST_SECOND = SETUP.settings.second_robot.T_base_second


@pytest.fixture(scope="module")
def programs():
    """What each robot mills, by its name."""
    return {name: plan(DOOR, T_CELL_DOOR, SETUP.of(name)).program for name in ("first", "second")}


def test_the_second_robot_changes_tools_as_its_features_need_it(programs):
    program = programs["second"]
    put, take, measure = MotionKind.PUT, MotionKind.TAKE, MotionKind.MEASURE
    work = [(m.kind, m.via) for m in program.motions if m.kind in RACK_KINDS]
    assert work == [(put, 0), (take, 1), (measure, 1), (put, 1), (take, 0), (measure, 0)]
    assert set(program.features) == {"lock_case", "face_plate"}


def test_what_both_robots_do_with_two_tools_each_touches_nothing(programs):
    executed = {
        name: run_file(render_target_file(program, RUN_ID).decode("ascii"))[0]
        for name, program in programs.items()
    }
    for path in executed.values():
        assert set(path.tool) == {"", "rack_mill_12", "rack_mill_16"}
    bases = {"first": np.eye(4), "second": T_FIRST_SECOND}
    milled = [Milled(name, bases[name], path) for name, path in executed.items()]
    verdict = judge_pair(DOOR, T_CELL_DOOR, milled, load_cell())
    assert verdict.error is None, verdict.sentence


def test_without_a_rack_it_has_one_tool():
    bare = replace(SETUP, layout=replace(SETUP.layout, rack_of_second=None))
    with pytest.raises(errors.ToolChangeError, match="has no rack"):
        plan(DOOR, T_CELL_DOOR, bare.of("second"))
