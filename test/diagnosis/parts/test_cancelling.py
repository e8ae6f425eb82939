"""Two causes that change at one door and nearly cancel: neither gains anything alone."""

from doormill_ros.diagnosis.core.words.verdict import EXPLAINED
from doormill_ros.diagnosis.parts.kind import Inspections
from support.random_shift import random_doors, random_shift
from support.shift_worlds import Hidden, judged

COUNT, STEP = 20, 10
HIDDEN = (Hidden("process_force", "tool", STEP), Hidden("tool_bending", "tool", STEP))


def test_a_softer_tool_in_softer_wood_is_both(tmp_path):
    change = {"from_door": STEP, "force": {"factor": 0.83}, "tool": {"stiffness": 2.66e6}}
    doors = random_shift(tmp_path, {"seed": 336, "change": [change]}, random_doors(336, COUNT), 336)
    diagnosis = Inspections().diagnose(doors, lambda line: None)
    found = judged(diagnosis, HIDDEN)
    assert (found.verdict, found.missed, found.wrong, found.late) == (EXPLAINED, (), (), ())
    force, bending = (
        next(one for one in diagnosis.findings if one.cause.name == hidden.cause) for hidden in HIDDEN
    )
    assert abs(force.values[0] - 0.83) < 0.03
    assert abs(bending.values[0] - 2.66e6) < 0.2e6
