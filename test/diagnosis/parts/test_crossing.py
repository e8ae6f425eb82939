"""The torque from which a gap is open is tried at some values: from a wrong one the search finds the right one."""

from __future__ import annotations

from pathlib import Path

from doormill_ros.diagnosis.core.searching.beam import BeamSearch
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import gauged_shift
from support.shift_worlds import draw_shift, inspected


def test_another_crossing_is_tried_from_where_everything_else_stands(tmp_path: Path) -> None:
    """A force that drifts and a weight, which nobody hid, put a wrong crossing nearly right.

    Fitted anew without the gap they go where no gap leads back from: the wrong model would stay.
    """
    seed = 1539
    drawn = draw_shift(seed)
    hidden = [(one.cause, one.where) for one in drawn.hidden]
    assert ("joint_backlash", "joint 2") in hidden
    assert ("gravity_sag", "tool") not in hidden
    doors = inspected(gauged_shift(tmp_path / "shift", drawn.world, drawn.doors, seed))
    problem = Inspections().problem(doors).changed_at((11, 12, 16))
    search = BeamSearch(problem, problem.candidates())
    by_name = {repr(one): one for one in search.candidates}
    names = [
        "joint_backlash at joint 2 (5 N m)",
        "process_force at tool (from door_012 on)",
        "gravity_sag at tool",
        "process_force_direction at tool (drifting)",
    ]
    wrong = search.fit([by_name[name] for name in names])
    # 2 N m comes as near beside the weight.
    exchanged = {repr(model.members[0]): model for model in next(iter(search._exchanged(wrong)))}
    right = exchanged["joint_backlash at joint 2 (0 N m)"]
    assert search.total(right) < search.total(wrong) - 20.0
    # What the wrong crossing needed does nothing beside the right one.
    assert search.total(search.without(right, by_name["gravity_sag at tool"])) < search.total(right)
    best = [repr(one) for one in search.finished(wrong).members]
    assert best == ["joint_backlash at joint 2 (0 N m)", names[1], "process_force_direction at tool"]
