"""Event routines as the system parameters name them."""

from __future__ import annotations

from functools import partial

import pytest

from doormill_ros.simulation.controller.configuration.event_routines import (
    check_event_routines,
    read_event_routines,
)
from doormill_ros.simulation.controller.rapid.errors import EventRoutinesError

HEAD = 'SYS:CFG_1.0:6:0::\n#\nCAB_TASK_MODULES:\n\n -File "HOME:/a.mod"\n#\nCAB_EXEC_HOOKS:\n\n'


@pytest.fixture
def read(read_configuration):
    return partial(read_configuration, read_event_routines)


def test_events_and_their_routines(read):
    found = read(
        HEAD
        + """      -Routine "late" -Shelf "QSTOP" -Task "T_ROB1" -SeqNo 2

      -Routine "early" -Shelf "QSTOP"\\
      -Task "T_ROB1" -SeqNo 1

      -Routine "up" -Shelf "POWER_ON" -AllTask

      -Routine "other" -Shelf "STOP" -Task "T_ROB2"
#
SYS_MISC:
      -Name "x" -Value "y"
"""
    )
    assert found == {"QSTOP": ("early", "late"), "POWERON": ("up",)}


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ('-Routine "a" -Shelf "HALT" -Task "T_ROB1"', "line 9: -Shelf is 'HALT'"),
        ('-Shelf "STOP" -Task "T_ROB1"', "without -Routine"),
        ('-Routine "a" -Shelf "STOP"', "without a task"),
        ('-Routine "a" -Shelf "STOP" -Task "T_ROB1" -Order 1', "found -Order"),
        ('-Routine "a" -Shelf "STOP" -Task "T_ROB1" -SeqNo "x"', "-SeqNo is 'x'"),
        ("\n".join(['-Routine "a" -Shelf "STOP" -Task "T_ROB1"'] * 21), "STOP has 21 routines"),
    ],
)
def test_entries_that_cannot_be(read, entry, words):
    with pytest.raises(EventRoutinesError, match=words):
        read(HEAD + entry + "\n")


def test_routines_have_to_be_loaded_procedures(load):
    rest = "PROC good() ENDPROC PROC one(num n) ENDPROC FUNC num f() RETURN 1; ENDFUNC TRAP t ENDTRAP"
    program = load("", "", rest)
    check_event_routines({"STOP": ("good",)}, program)
    for name in ("one", "f", "t", "nothing", "TPErase"):
        with pytest.raises(EventRoutinesError, match=f"event STOP calls {name}"):
            check_event_routines({"STOP": (name,)}, program)


def test_a_controller_runs_what_its_system_parameters_name(tmp_path, controller):
    module, system = tmp_path / "events.mod", tmp_path / "SYS.cfg"
    module.write_text(
        'MODULE events\nPROC main() TPWrite "main"; ENDPROC\nPROC up() TPWrite "up"; ENDPROC\nENDMODULE\n'
    )
    system.write_text(HEAD + '-Routine "up" -Shelf "START" -Task "T_ROB1"\n')
    robot = controller(modules=[module], expected_door=None, system_parameters=system)
    robot.run()
    assert robot.pendant_lines == ["up", "main"]
    system.write_text(HEAD + '-Routine "down" -Shelf "START" -Task "T_ROB1"\n')
    with pytest.raises(EventRoutinesError, match="event START calls down"):
        controller(modules=[module], expected_door=None, system_parameters=system)
