"""When the spindle of the simulated cell turned."""

import numpy as np
import pytest

from doormill_ros.resources import resource
from doormill_ros.simulation.controller.operation.configuration import read_system_outputs

TIMES = np.array([0.0, 1.0, 2.4, 2.6, 4.0, 4.9, 5.1, 9.0])


@pytest.fixture
def told(controller):
    """The controller, and a function that writes an output and lets the cross connections follow."""
    one, outputs = controller(), read_system_outputs(resource("rapid/EIO.cfg"))

    def write(name, value, now, cycle_on=True):
        if name is not None:
            one.cell.write(name, value, now)
        one.cell.advance(now)
        outputs.update({"CycleOn": int(cycle_on)}, one.cell.read, one.cell.force)

    assert outputs.status == {"CycleOn": "soCycleOn"}
    return one, write


def test_it_turns_from_when_it_is_at_speed_until_it_is_switched_off(told):
    one, write = told
    assert not one.spindle_turned(TIMES).any()
    write("aoSpindleSpeed", 6000, 1.0)
    write("doSpindleOn", 1, 1.0)
    one.cell.advance(2.5)  # 1.5 s later
    write("aoSpindleSpeed", 9000, 3.0)  # another speed: it goes on turning
    one.cell.advance(4.5)
    write("doSpindleOn", 0, 5.0)
    one.cell.advance(6.5)
    assert one.spindle_turned(TIMES).tolist() == [False, False, False, True, True, True, False, False]


def test_it_is_switched_off_when_the_program_stops_too(told):
    """The drive runs while the program does, whatever the program's own output says."""
    one, write = told
    write("aoSpindleSpeed", 6000, 1.0)
    write("doSpindleOn", 1, 1.0)
    one.cell.advance(2.5)
    write(None, 0, 5.0, cycle_on=False)
    one.cell.advance(6.5)
    assert one.cell.read("doSpindleOn") == 1.0
    assert one.spindle_turned(TIMES).tolist() == [False, False, False, True, True, True, False, False]


@pytest.mark.parametrize("signal", ["diGuardClosed", "diToolClamped"])
def test_it_does_not_turn_beside_an_open_guard_or_with_a_loose_tool_whoever_sets_the_output(told, signal):
    one, write = told
    write("aoSpindleSpeed", 6000, 1.0)
    write("doSpindleOn", 1, 1.0)
    assert one.cell.read("doSpindleRun") == 1.0
    if signal == "diToolClamped":
        one.cell.rack.carried = ""
    else:
        one.cell.set_input(signal, 0.0)
    write(None, 0, 1.1)
    assert one.cell.read("doSpindleRun") == 0.0
    one.cell.advance(4.0)
    assert not one.spindle_turned(TIMES).any()


def test_the_drawbar_stays_shut_while_the_spindle_turns_whoever_sets_the_output(told):
    one, write = told
    write("aoSpindleSpeed", 6000, 1.0)
    write("doSpindleOn", 1, 1.0)
    write(None, 0, 2.5)
    assert one.cell.read("diSpindleAtSpeed") == 1.0
    write("doDrawbarOpen", 1, 3.0)
    write(None, 0, 3.5)
    assert one.cell.rack.harm == []
    assert not one.cell.rack.opened


def test_the_drawbar_opens_at_rest(told):
    one, write = told
    write("doDrawbarOpen", 1, 1.0)
    write(None, 0, 1.5)
    assert one.cell.rack.opened
    write("doDrawbarOpen", 0, 2.0)
    write(None, 0, 2.5)
    assert not one.cell.rack.opened
