"""Two causes that change at one door and nearly cancel: neither gains anything alone."""

from doormill_ros.diagnosis.core.words.verdict import EXPLAINED
from doormill_ros.diagnosis.parts.kind import Inspections
from support.random_shift import random_doors, random_shift
from support.shift_worlds import Hidden, judged

COUNT, STEP, SEED = 31, 19, 336
TOOL = {"mass": 8.669115060431775, "com": [0.0, 0.0, 0.16419230196048673]}
FACTOR, STIFFNESS = 0.8276851072505914, 2661567.8836166263  # [], [N / m]
HIDDEN = (
    Hidden("gravity_sag", "tool"),
    Hidden("process_force", "tool", STEP),
    Hidden("tool_bending", "tool", STEP),
)


def test_a_softer_tool_in_softer_wood_is_both(tmp_path):
    change = {"from_door": STEP, "force": {"factor": FACTOR}, "tool": {**TOOL, "stiffness": STIFFNESS}}
    world = {"seed": SEED, "tool": TOOL, "change": [change]}
    doors = random_shift(tmp_path, world, random_doors(SEED, COUNT), SEED)
    diagnosis = Inspections().diagnose(doors, lambda line: None)
    found = judged(diagnosis, HIDDEN)
    assert (found.verdict, found.missed, found.wrong, found.late) == (EXPLAINED, (), (), ())
    values = {finding.cause.name: finding.values[0] for finding in diagnosis.findings}
    assert abs(values["process_force"] - FACTOR) < 0.03
    assert abs(values["tool_bending"] / STIFFNESS - 1.0) < 0.1
