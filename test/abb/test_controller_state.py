"""How the controller is, read over both versions of the web services, and what it forbids."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.controller_state import ControllerReading, ControllerWatch
from doormill_ros.abb.link_errors import ControllerStateError, SignalAccessError
from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import OperatingMode, StopCause
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.memory_transport import MemoryTransport

FIT = ControllerReading("AUTO", "motoron", "running", 1.0)


@pytest.fixture
def panel(server: RwsServer) -> ControlPanel:
    return server.cabinet.idle.panel


def test_only_web_services_tell_how_the_controller_is(link: RwsTransport, tmp_path: Path) -> None:
    folder = SimulatedFolderTransport(tmp_path)
    assert [isinstance(t, ControllerWatch) for t in (link, folder, MemoryTransport())] == [True, False, False]
    folder.close()


def test_a_controller_that_takes_files(link: RwsTransport, panel: ControlPanel) -> None:
    assert link.read_controller() == FIT
    link.read_controller().require_fit()
    panel.set_speed_override(40.0)
    assert link.read_controller().speed_override == pytest.approx(0.4)


def stop(panel: ControlPanel) -> None:
    panel.stop()
    panel.stopped(StopCause.PROGRAM_STOP, "ordered")


@pytest.mark.parametrize(
    ("happens", "field", "value", "advice"),
    [
        (lambda p: p.emergency_stop(), "controller_state", "emergencystop", "release it"),
        (lambda p: p.open_guard(), "controller_state", "guardstop", "close it"),
        (lambda p: p.motors(False), "controller_state", "motoroff", "switch them on"),
        (stop, "execution_state", "stopped", "start it"),
        (lambda p: p.set_speed_override(0.0), "speed_override", 0.0, "raise it"),
    ],
)
def test_what_forbids_a_file_says_what_to_do(
    link: RwsTransport, panel: ControlPanel, happens: object, field: str, value: object, advice: str
) -> None:
    happens(panel)
    reading = link.read_controller()
    assert getattr(reading, field) == value
    with pytest.raises(ControllerStateError, match=advice):
        reading.require_fit()


def test_manual_mode_needs_the_privilege_that_the_operator_grants(
    link: RwsTransport, server: RwsServer, panel: ControlPanel
) -> None:
    panel.set_mode(OperatingMode.MANUAL_REDUCED)
    panel.motors(True)
    assert not link.read_controller().privilege
    with pytest.raises(SignalAccessError, match="manual mode"):
        link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 0
    assert not link.read_controller(ask_privilege=True).privilege  # asked now
    assert not link.read_controller(ask_privilege=True).privilege  # the operator has not answered
    server.cabinet.answers_privilege = "GRANTED"
    reading = link.read_controller(ask_privilege=True)
    assert (reading.operating_mode, reading.privilege) == ("MANR", True)
    reading.require_fit()
    link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 1


def test_new_events_alone(link: RwsTransport, panel: ControlPanel) -> None:
    panel.set_speed_override(50.0)
    panel.motors(False)
    assert link.read_events() == ()
    panel.motors(True)
    panel.emergency_stop()
    events = link.read_events()
    assert [(e.severity, e.code) for e in events] == [(1, 10011), (3, 10013)]
    assert events[1].title == "Emergency stop state"
    assert link.read_events() == ()


@pytest.mark.parametrize("server", [2], indirect=True)
def test_a_removal_has_the_headers_that_version_2_insists_on(
    link: RwsTransport, server: RwsServer, tmp_path: Path
) -> None:
    link.write_file("Hei2.txt", b"x")
    link.remove_file("Hei2.txt")
    assert not (tmp_path / "Hei2.txt").exists()
    assert server.services.requests[-1][2] == 204
    bare = link._http.request("DELETE", "/fileservice/HOME/Hei2.txt")
    assert bare.status_code == 406
