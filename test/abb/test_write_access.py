"""RobotWare 8: this PC as a control station, against simulated web services that refuse every write without access."""

from __future__ import annotations

import ssl
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.handshake.loop import HandshakeLoop
from doormill_ros.abb.handshake.sharing import SharedHandshake
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import WriteAccessError
from doormill_ros.abb.transports import control_station
from doormill_ros.abb.transports.rws import RwsTransport, connect_rws2
from doormill_ros.simulation.controller.operation.states import OperatingMode
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.control_stations import ControlStations
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.waiting import LIMIT, until
from support.web_services import link_to

LOGIN = Credentials("Default User", "robotics", "4711")
FORM = "application/x-www-form-urlencoded;v=2.0"
OTHER = "{0f7bd9a1-6d5e-4c4b-9b43-0a6f3c1d2e55}"
STATION = "/rw/controlstation"


@pytest.fixture
def server(tmp_path: Path) -> Iterator[RwsServer]:
    with RwsServer(Cabinet.create(tmp_path), 2, robotware=8) as running:
        yield running


@pytest.fixture
def stations(server: RwsServer) -> ControlStations:
    return server.services.operations.rights.control_stations()


def connect(server: RwsServer, credentials: Credentials = LOGIN) -> RwsTransport:
    return link_to(server, credentials)


@pytest.fixture
def link(server: RwsServer) -> Iterator[RwsTransport]:
    transport = connect(server)
    yield transport
    transport.close()


@pytest.fixture
def rival(server: RwsServer) -> Iterator[httpx.Client]:
    """Another client."""
    trust = ssl.create_default_context(cafile=str(server.certificate))
    headers = {"Accept": "application/hal+json;v=2.0", "Content-Type": FORM, "Content-Length": "0"}
    with httpx.Client(
        auth=("Default User", "robotics"), base_url=server.url, headers=headers, verify=trust, timeout=LIMIT
    ) as client:
        yield client


def post(client: httpx.Client, path: str, **form: str) -> tuple[int, int]:
    """Status and return code."""
    body = "&".join(f"{key.replace('_', '-')}={value}" for key, value in form.items())
    headers = {"Content-Type": FORM, "Content-Length": str(len(body))}
    answer = client.post(path, content=body, headers=headers)
    return answer.status_code, answer.json()["status"]["code"] if answer.content else 0


def register(client: httpx.Client, station: str = OTHER, pin: str = "1") -> tuple[int, int]:
    return post(
        client,
        f"{STATION}/register/remote",
        control_station_name="x",
        control_station_id=station,
        pincode=pin,
    )


def test_what_the_controller_answers(
    server: RwsServer, stations: ControlStations, rival: httpx.Client
) -> None:
    ready = f"/rw/iosystem/signals/{signals.READY}/set-value"
    assert post(rival, "/rw/mastership/edit/request")[0] == 410
    assert post(rival, ready, lvalue="1") == (403, -1073435871)
    assert post(rival, f"{STATION}/writeaccess/request") == (403, -1073435871)
    assert register(rival, OTHER.strip("{}"))[0] == 400
    assert register(rival) == (204, 0)
    assert post(rival, ready, lvalue="1") == (403, -1073435873)
    assert post(rival, f"{STATION}/writeaccess/release") == (403, -1073435873)
    stations.take_locally()
    assert post(rival, f"{STATION}/writeaccess/request") == (403, -1073435870)
    stations.give_locally()
    assert post(rival, f"{STATION}/writeaccess/request") == (204, 0)
    # One write ends the hold, and the session writes on.
    for level in ("1", "0", "1"):
        assert post(rival, ready, lvalue=level) == (204, 0)
        assert "false" in rival.get(f"{STATION}/writeaccess/status").text
    assert post(rival, f"{STATION}/writeaccess/release") == (403, -1073435873)
    assert server.cabinet.value(signals.READY) == 1


def test_before_robotware_8_there_is_no_control_station(tmp_path: Path) -> None:
    with RwsServer(Cabinet.create(tmp_path), 2) as server:
        link = connect(server)
        link.set_ready(True)
        link.remove_file("Hei2.txt")
        link.close()
        assert not [path for _, path, _ in server.services.requests if path.startswith(STATION)]
        assert server.cabinet.value(signals.READY) == 1


def test_signals_and_files_are_written(link: RwsTransport, server: RwsServer, tmp_path: Path) -> None:
    link.set_ready(False)
    link.write_file("Hei2.txt", b"1;\n")
    link.write_number(signals.READY_NUMBER, 7)
    link.set_ready(True)
    assert (tmp_path / "Hei2.txt").read_bytes() == b"1;\n"
    assert (server.cabinet.value(signals.READY), server.cabinet.value(signals.READY_NUMBER)) == (1, 7)
    link.remove_file("Hei2.txt")
    assert not (tmp_path / "Hei2.txt").exists()
    asked = [path for _, path, _ in server.services.requests if path.startswith(STATION)]
    assert asked == [f"{STATION}/register/remote", f"{STATION}/writeaccess/request"]


def test_raising_is_not_repeated_once_the_pendant_had_the_access(
    link: RwsTransport, server: RwsServer, stations: ControlStations
) -> None:
    link.set_ready(False)
    stations.take_locally()
    with pytest.raises(WriteAccessError, match="pendant"):
        link.set_ready(True)
    stations.give_locally()
    with pytest.raises(WriteAccessError, match="picture"):
        link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 0
    link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 1


def test_another_station_is_named_and_then_waited_out(
    link: RwsTransport, rival: httpx.Client, tmp_path: Path
) -> None:
    register(rival)
    post(rival, f"{STATION}/writeaccess/request")
    with pytest.raises(WriteAccessError, match="another control station"):
        link.write_file("Hei2.txt", b"1;\n")
    assert not (tmp_path / "Hei2.txt").exists()
    post(rival, f"{STATION}/writeaccess/release")
    link.write_file("Hei2.txt", b"1;\n")
    assert (tmp_path / "Hei2.txt").exists()


def test_a_new_session_registers_anew(link: RwsTransport, server: RwsServer) -> None:
    link.set_ready(False)
    server.expire_sessions()
    link.set_ready(False)
    link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 1


def test_what_a_killed_process_held_is_its_successor_s_own(
    server: RwsServer, stations: ControlStations, rival: httpx.Client
) -> None:
    killed = connect(server)
    killed._station.take()
    server.expire_sessions()  # nobody logged out or released
    register(rival)
    assert post(rival, f"{STATION}/writeaccess/request") == (403, -1073435870)
    successor = connect(server)
    successor.set_ready(False)
    successor.set_ready(True)
    assert server.cabinet.value(signals.READY) == 1
    successor.close()
    killed.close()


def test_closing_gives_the_access_back(server: RwsServer, rival: httpx.Client) -> None:
    link = connect(server)
    link.set_ready(False)
    link._station.take()
    link.close()
    register(rival)
    assert post(rival, f"{STATION}/writeaccess/request") == (204, 0)


def test_without_a_pin_it_says_what_to_do(server: RwsServer) -> None:
    link = connect(server, Credentials("Default User", "robotics"))
    with pytest.raises(WriteAccessError, match="DOORMILL_CONTROLLER_PIN"):
        link.set_ready(False)
    link.close()


def test_another_pin_than_the_station_s(server: RwsServer, rival: httpx.Client) -> None:
    link = connect(server)
    register(rival, link._station.id, "1")
    with pytest.raises(WriteAccessError, match="check the PIN"):
        link.set_ready(False)
    link.close()


def test_each_pc_and_controller_has_a_station_of_its_own(
    server: RwsServer, link: RwsTransport, monkeypatch: pytest.MonkeyPatch
) -> None:
    same = connect(server)
    elsewhere = connect_rws2("https://192.0.2.1", LOGIN, insecure=True, subscribe=False)
    own = link._station.id
    assert same._station.id == own
    assert elsewhere._station.id != own
    monkeypatch.setattr(control_station.socket, "gethostname", lambda: "another")
    assert link._station.id != own
    same.close()
    elsewhere.close()


def test_in_manual_mode_nobody_grants_a_privilege(link: RwsTransport, server: RwsServer) -> None:
    server.cabinet.idle.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    assert link.read_controller(ask_privilege=True).privilege is False


def test_a_handshake_over_it(server: RwsServer, tmp_path: Path) -> None:
    def until_state(state: State) -> None:
        until(lambda: handshake.snapshot.state is state, lambda: handshake.snapshot)

    link = connect(server)
    link.in_doubt_time = 0.0  # nothing comes late here
    cabinet, handshake = server.cabinet, SharedHandshake(link)
    with HandshakeLoop(handshake):
        until_state(State.IDLE)
        (tmp_path / signals.REQUEST_FILE).write_text("3\n")
        cabinet.set_value(signals.REQUEST, 1)
        until_state(State.REQUESTED)
        handshake.submit("run", "door", b"1;2;\n")
        until_state(State.READY)
        assert cabinet.value(signals.READY_NUMBER) == 3
        assert (tmp_path / signals.TARGET_FILE).read_bytes() == b"1;2;\n"
        (tmp_path / signals.ACCEPTED_FILE).write_text("run\n3\n")
        cabinet.set_value(signals.REQUEST, 0)
        until_state(State.MILLING)
        cabinet.set_value(signals.DONE, 1)
        until_state(State.DONE)
    assert handshake.outcome("run").milled is True
