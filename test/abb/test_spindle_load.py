"""The spindle's load: read over every transport, of milling alone, and missing without harm."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.analog_inputs import AnalogInputs, decimal
from doormill_ros.abb.handshake.spindle_load import LoadSample, SpindleLoadMeter
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import ReadTimeoutError, SignalReadError, UnknownSignalError
from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.simulation.controller.configuration.io_configuration import read_io_configuration
from doormill_ros.simulation.controller.rws_server.cabinet import SimulatedSignal
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.memory_transport import MemoryTransport
from support.source_tree import ROOT

MILLING = HandshakeSnapshot(HandshakeState.MILLING, "", 0.0, run_id="one")


class Inputs(MemoryTransport):
    """A transport whose controller tells a load, or raises; `after` is what has happened once it was asked."""

    def __init__(self, told: float | Exception, after: HandshakeSnapshot = MILLING) -> None:
        super().__init__()
        self.told, self.after, self.asked = told, after, 0
        self.snapshot = MILLING

    def read_analog(self, name: str) -> float:
        assert name == signals.SPINDLE_LOAD
        self.asked += 1
        self.snapshot = self.after
        if isinstance(self.told, Exception):
            raise self.told
        return self.told


def meter_of(inputs: Inputs) -> SpindleLoadMeter:
    return SpindleLoadMeter(inputs, lambda: inputs.snapshot)


def test_the_share_of_the_nominal_power_is_told_with_its_run() -> None:
    assert meter_of(Inputs(37.5)).sample() == LoadSample("one", pytest.approx(0.375))


@pytest.mark.parametrize("state", [state for state in HandshakeState if state is not HandshakeState.MILLING])
def test_nothing_but_milling_is_asked_for(state: HandshakeState) -> None:
    inputs = Inputs(37.5)
    inputs.snapshot = replace(MILLING, state=state)
    assert meter_of(inputs).sample() is None
    assert not inputs.asked


@pytest.mark.parametrize(
    "after", [replace(MILLING, state=HandshakeState.DONE), replace(MILLING, run_id="two")]
)
def test_a_look_during_which_the_milling_ended_tells_nothing(after: HandshakeSnapshot) -> None:
    inputs = Inputs(37.5, after)
    assert meter_of(inputs).sample() is None
    assert inputs.asked == 1


def test_a_controller_without_the_signal_is_asked_once() -> None:
    inputs = Inputs(UnknownSignalError("no such signal"))
    meter = meter_of(inputs)
    with pytest.raises(UnknownSignalError):
        meter.sample()
    assert not meter.able
    assert [meter.sample() for _ in range(3)] == [None] * 3
    assert inputs.asked == 1


def test_a_controller_that_does_not_answer_is_asked_again() -> None:
    inputs = Inputs(ReadTimeoutError("slow"))
    meter = meter_of(inputs)
    for _ in range(2):
        with pytest.raises(ReadTimeoutError):
            meter.sample()
    inputs.told = 5.0
    assert meter.sample() == LoadSample("one", pytest.approx(0.05))


def test_a_transport_that_reads_no_analog_signal_is_not_asked() -> None:
    transport = MemoryTransport()
    assert not isinstance(transport, AnalogInputs)
    meter = SpindleLoadMeter(transport, lambda: MILLING)
    assert not meter.able
    assert meter.sample() is None


@pytest.mark.parametrize(
    ("text", "value"),
    [("12.5", 12.5), ("0", 0.0), ("-3", -3.0), ("1.67772E+07", 1.67772e7), (" 4 ", 4.0), ("7.", 7.0)],
)
def test_numbers_as_controllers_write_them(text: str, value: float) -> None:
    assert decimal(text) == value


@pytest.mark.parametrize(
    "text", ["", "nan", "inf", "1e999", "0x10", "1_0", "12,5", "one", "\u0661", "9" * 400]
)
def test_what_is_no_finite_number_is_none(text: str) -> None:
    assert decimal(text) is None


@pytest.fixture
def folder(tmp_path: Path):
    transport = SimulatedFolderTransport(tmp_path, timeout=60.0)
    yield transport
    transport.close()


def test_the_simulated_folder_holds_it_in_a_file(folder: SimulatedFolderTransport, tmp_path: Path) -> None:
    file = tmp_path / "io" / signals.SPINDLE_LOAD
    with pytest.raises(UnknownSignalError, match=signals.SPINDLE_LOAD):
        folder.read_analog(signals.SPINDLE_LOAD)
    file.write_text("18.25\n")
    assert folder.read_analog(signals.SPINDLE_LOAD) == 18.25
    file.write_text("much")
    with pytest.raises(SignalReadError, match="much"):
        folder.read_analog(signals.SPINDLE_LOAD)


def test_web_services_tell_it(link: RwsTransport, server: RwsServer) -> None:
    assert isinstance(link, AnalogInputs)
    with pytest.raises(UnknownSignalError, match=signals.SPINDLE_LOAD):
        link.read_analog(signals.SPINDLE_LOAD)
    server.cabinet.signals[signals.SPINDLE_LOAD] = SimulatedSignal(
        signals.SPINDLE_LOAD, kind="AI", largest=200.0
    )
    for percent in (0.0, 12.5, 104.25):
        server.cabinet.set_value(signals.SPINDLE_LOAD, percent)
        assert link.read_analog(signals.SPINDLE_LOAD) == pytest.approx(percent)


@pytest.mark.parametrize("file", ["rapid/EIO.cfg", "rapid/rw7/EIO.cfg"])
def test_both_configurations_have_it_in_percent_of_the_nominal_power(file: str) -> None:
    signal = read_io_configuration(ROOT / file).signals[signals.SPINDLE_LOAD]
    assert (signal.type, signal.lowest) == ("AI", 0.0)
    assert signal.largest > 100.0
