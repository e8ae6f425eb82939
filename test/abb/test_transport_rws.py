"""Both versions of the web services as transports, over real HTTP and WebSocket on loopback."""

from __future__ import annotations

import contextlib
import re
import socket
import subprocess
import threading
import time
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import (
    CertificateError,
    ConnectError,
    ConnectionLostError,
    ControllerBusyError,
    ControllerReplyError,
    FileMissingError,
    FileNameError,
    LinkError,
    LoginError,
    ReadTimeoutError,
    SessionExpiredError,
    SignalAccessError,
    UnknownSignalError,
    UploadError,
    WriteTimeoutError,
)
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transports import rws_http
from doormill_ros.abb.transports.rws import RwsTransport, connect_rws1, connect_rws2
from doormill_ros.abb.transports.rws_address import tls_context
from doormill_ros.abb.transports.rws_dialect import RWS1, RWS2
from doormill_ros.abb.transports.rws_http import LinkTimeouts, map_http_error
from doormill_ros.simulation.controller.configuration.io_configuration import ACCESS_LEVELS, SignalAccess
from doormill_ros.simulation.controller.rws_server.cabinet import (
    Cabinet,
    SimulatedSignal,
    default_signals,
)
from doormill_ros.simulation.controller.rws_server.certificate import write_certificate
from doormill_ros.simulation.controller.rws_server.reply import CODE_INVALID, RefusalError
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.source_tree import ROOT
from support.waiting import LIMIT, until
from support.web_services import LOGIN, PATIENT, link_to


@pytest.fixture
def listening(server: RwsServer):
    transport = link_to(server, subscribe=True, poll_interval=0.1)
    until(lambda: transport.events.live)
    yield transport
    transport.close()


def test_is_a_transport(link: RwsTransport) -> None:
    assert isinstance(link, Transport)


def test_files_come_back_byte_for_byte_and_go_away(
    link: RwsTransport, server: RwsServer, tmp_path: Path
) -> None:
    data = bytes(range(256)) * 10
    for content in (b"older and longer" * 1000, data):
        link.write_file("Hei2.txt", content)
    assert (tmp_path / "Hei2.txt").read_bytes() == data
    assert link.read_file("Hei2.txt") == data
    link.remove_file("Hei2.txt")
    link.remove_file("Hei2.txt")
    with pytest.raises(FileMissingError):
        link.read_file("Hei2.txt")
    folder = "$home" if server.version == 1 else "HOME"
    paths = {path for _, path, _ in server.services.requests}
    assert paths == {f"/fileservice/{folder}/Hei2.txt"}  # as it went over the wire: no %24


def test_signals(link: RwsTransport, server: RwsServer) -> None:
    for value in (True, False, True):
        server.cabinet.set_value(signals.REQUEST, int(value))
        assert link.read_signal(signals.REQUEST) is value
        link.set_ready(value)
        assert server.cabinet.value(signals.READY) == int(value)
        assert link.read_ready() is value


def test_one_session_is_kept_and_given_back(server: RwsServer) -> None:
    link = link_to(server, subscribe=True)
    for _ in range(20):
        link.read_ready()
    until(lambda: link.events.live)
    assert server.services.sessions.created == 1
    link.close()
    link.close()
    assert not server.services.sessions.sessions
    assert not server.services.subscriptions.groups
    unanswered = [path for _, path, status in server.services.requests if status == 401]
    assert len(unanswered) <= 1  # the one digest challenge


def test_an_expired_session_is_opened_again(link: RwsTransport, server: RwsServer) -> None:
    link.read_ready()
    server.expire_sessions()
    assert link.read_ready() is False
    assert server.services.sessions.created == 2
    server.expire_sessions()
    link.set_ready(False)
    assert server.services.sessions.created == 3


def test_raising_is_sent_a_single_time(link: RwsTransport, server: RwsServer) -> None:
    """Between two tries the robot may have asked for another door; the handshake has to look again."""
    posts = lambda: [status for method, _, status in server.services.requests if method == "POST"]  # noqa: E731
    link.read_ready()
    server.expire_sessions()
    with pytest.raises(SessionExpiredError):
        link.set_ready(True)
    assert posts() == [401]
    assert link.read_ready() is False
    link.set_ready(True)
    assert link.read_ready() is True
    server.services.behaviour.requests_per_second = 0
    with pytest.raises(ControllerBusyError):
        link.set_ready(True)
    assert posts()[2:] == [503]
    server.services.behaviour.requests_per_second = None
    link.set_ready(False)


def test_waiting_for_its_turn_takes_nothing_of_an_operations_time(
    link: RwsTransport, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An hour passes until the controller may be asked; the operation has its seconds from then on."""
    waited: list[int] = []

    class Clock:
        sleep = staticmethod(time.sleep)

        @staticmethod
        def monotonic() -> float:
            return time.monotonic() + 3600.0 * bool(waited)

    monkeypatch.setattr(rws_http, "time", Clock)
    monkeypatch.setattr(link._http._pace, "wait", waited.append)
    assert link.read_ready() is False
    assert waited


def test_a_wrong_password_is_named_and_not_tried_for_ever(server: RwsServer) -> None:
    link = link_to(server, Credentials("Default User", "wrong"))
    with pytest.raises(LoginError, match="'Default User'"):
        link.read_ready()
    assert len(server.services.requests) <= 3
    link.close()


@pytest.mark.parametrize("level", [ACCESS_LEVELS["Default"], ACCESS_LEVELS["ReadOnly"]])
def test_a_wrong_access_level_says_what_to_do(server: RwsServer, level: SignalAccess) -> None:
    server.cabinet.signals[signals.READY] = SimulatedSignal(signals.READY, level)
    link = link_to(server)
    with pytest.raises(SignalAccessError, match=r"-1073445881.*Access Level All.*cross-connect"):
        link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 0
    link.close()


def test_a_signal_that_does_not_exist(server: RwsServer) -> None:
    del server.cabinet.signals[signals.FAULT]
    link = link_to(server)
    with pytest.raises(UnknownSignalError, match=signals.FAULT):
        link.read_signal(signals.FAULT)
    link.close()


def test_signals_on_a_device(server: RwsServer) -> None:
    server.cabinet.signals = {
        s.name: SimulatedSignal(s.name, s.access, "Local", "DRV_1") for s in default_signals()
    }
    paths = {name: f"Local/DRV_1/{name}" for name in signals.ALL_SIGNALS}
    link = link_to(server, signal_paths=paths, subscribe=True, poll_interval=30.0)
    until(lambda: link.events.live)
    link.read_request()
    server.cabinet.set_value(signals.REQUEST, 1)
    until(link.read_request)
    link.set_ready(True)
    assert server.cabinet.value(signals.READY) == 1
    link.close()


def test_a_full_session_table_is_waited_for(server: RwsServer, monkeypatch: pytest.MonkeyPatch) -> None:
    server.services.sessions.limit = 1
    other = link_to(server)
    other.read_ready()
    link = link_to(server)
    with monkeypatch.context() as patch:
        patch.setattr(rws_http, "_BUSY_FIRST", PATIENT.total)  # the first pause is longer than the limit
        with pytest.raises(ControllerBusyError, match="close other clients"):
            link.read_ready()
    threading.Timer(0.2, other.close).start()
    assert link.read_ready() is False
    link.close()


def test_nothing_but_plain_names(link: RwsTransport, server: RwsServer) -> None:
    with pytest.raises(FileNameError):
        link.write_file("../x", b"")
    assert not server.services.requests


def test_a_write_that_the_controller_cannot_do(link: RwsTransport, tmp_path: Path) -> None:
    (tmp_path / "Hei2.txt").mkdir()
    with pytest.raises(UploadError, match="status 500"):
        link.write_file("Hei2.txt", b"x")


def test_both_edges_in_order(listening: RwsTransport, server: RwsServer) -> None:
    listening._poll_interval = 60.0  # events alone
    listening.read_request()
    group = next(iter(server.services.subscriptions.groups.values()))
    seen = []
    for value in (1, 0, 1, 0):
        count = len(listening.events._edges)
        server.cabinet.set_value(signals.REQUEST, value)
        until(lambda count=count: len(listening.events._edges) > count)
    for _ in range(4):
        seen.append(listening.read_request())
    assert seen == [True, False, True, False]
    assert group.streams


def test_an_event_ends_the_wait(listening: RwsTransport, server: RwsServer) -> None:
    listening._poll_interval = 60.0
    listening.read_request()
    listening._woken.clear()
    threading.Timer(0.05, server.cabinet.set_value, [signals.REQUEST, 1]).start()
    begin = time.monotonic()
    listening.wait(LIMIT)
    assert time.monotonic() - begin < LIMIT
    until(listening.read_request)


def test_a_request_raised_before_the_subscription_is_seen(server: RwsServer) -> None:
    server.cabinet.set_value(signals.REQUEST, 1)
    link = link_to(server, subscribe=True)
    until(lambda: link.events.live)
    assert link.read_request() is True
    link.close()


def test_a_broken_stream_is_replaced_and_polling_bridges_the_gap(
    listening: RwsTransport, server: RwsServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise RefusalError(500, CODE_INVALID, "not now")

    with monkeypatch.context() as patch:
        patch.setattr(server.services.subscriptions, "create", refuse)
        server.drop_streams()
        until(lambda: not listening.events.live)
        server.cabinet.set_value(signals.REQUEST, 1)
        until(listening.read_request)
        assert not listening.events.live
    until(lambda: listening.events.live)
    assert len(server.services.subscriptions.groups) == 1
    listening._poll_interval = 60.0
    server.cabinet.set_value(signals.REQUEST, 0)
    until(lambda: not listening.read_request())


def test_a_slow_controller_ends_in_a_timeout(server: RwsServer) -> None:
    link = link_to(server)
    link.read_ready()
    client, patience = link._http._client, link._http._client.timeout
    server.services.behaviour.delay = 600.0
    client.timeout = httpx.Timeout(0.2)
    with pytest.raises(ReadTimeoutError):
        link.read_ready()
    with pytest.raises(LinkError) as caught:
        link.set_ready(True)
    assert caught.value.in_doubt
    server.services.behaviour.delay = 0.0
    client.timeout = patience
    link.set_ready(False)
    assert link.read_ready() is False
    link.close()


class Silent:
    """Accepts connections and says what it is told, byte by byte, or nothing."""

    def __init__(self, answer: bytes = b"", pause: float = 0.0, silent: int = 0) -> None:
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.socket.getsockname()[1]}"
        self.connections: list[socket.socket] = []
        self.answer, self.pause, self.silent = answer, pause, silent
        threading.Thread(target=self.run, daemon=True).start()

    def run(self) -> None:
        while True:
            try:
                connection, _ = self.socket.accept()
                self.connections.append(connection)
                if len(self.connections) <= self.silent:
                    continue
                if self.answer:
                    connection.recv(65536)
                for i in range(len(self.answer)):
                    connection.sendall(self.answer[i : i + 1])
                    if self.pause:
                        time.sleep(self.pause)
                if self.answer and not self.pause:
                    connection.close()
            except OSError:
                return

    def close(self) -> None:
        self.socket.close()
        for connection in self.connections:
            connection.close()


@pytest.mark.parametrize("total", [0.3])
def test_an_answer_that_trickles_in_is_cut_off(total: float) -> None:
    """Each byte resets a read timeout; only the limit on the whole operation ends this."""
    server = Silent(b"HTTP/1.1 200 OK\r\nContent-Length: 100000\r\n\r\n" + b"x" * 100_000, pause=0.02)
    link = connect_rws1(server.url, LOGIN, timeouts=LinkTimeouts(total=total), subscribe=False)
    with pytest.raises(ReadTimeoutError, match="longer than"):
        link.read_file("Hei2.txt")
    with pytest.raises(WriteTimeoutError):
        link.set_ready(True)
    server.close()
    link.close()


def test_a_call_that_hangs_is_ended_and_does_not_hold_up_the_next() -> None:
    """The first connection says nothing for longer than this test lasts."""
    server = Silent(b"HTTP/1.1 201 Created\r\nContent-Length: 0\r\n\r\n", silent=1)
    patient = LinkTimeouts(read=600.0, total=0.5)
    link = connect_rws1(server.url, LOGIN, timeouts=patient, subscribe=False)
    with pytest.raises(ReadTimeoutError, match="longer than"):
        link.read_ready()

    def written() -> bool:
        with contextlib.suppress(LinkError):  # a busy machine may take longer than the limit
            link.write_file("Hei2.txt", b"x")
            return True
        return False

    until(written)
    server.close()
    link.close()


def test_a_controller_that_never_answers() -> None:
    server = Silent()
    link = connect_rws1(server.url, LOGIN, timeouts=LinkTimeouts(read=0.2), subscribe=False)
    with pytest.raises(ReadTimeoutError):
        link.read_ready()
    server.close()
    link.close()


def test_a_connection_that_breaks() -> None:
    server = Silent(b"HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\nhalf")
    link = connect_rws1(server.url, LOGIN, timeouts=PATIENT, subscribe=False)
    with pytest.raises(ConnectionLostError) as caught:
        link.write_file("Hei2.txt", b"x")
    assert caught.value.in_doubt
    assert len(server.connections) == 1  # an upload is not repeated on its own
    with pytest.raises(ConnectionLostError):
        link.read_ready()
    assert len(server.connections) == 3  # a question is, once
    server.close()
    link.close()


@pytest.mark.parametrize("body", [b"", b"{}", b"[]", b'{"_embedded": {"_state": 1}}', b"<html/>", b"\xff"])
def test_answers_of_something_else_than_a_controller(body: bytes) -> None:
    answer = b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % len(body) + body
    server = Silent(answer)
    link = connect_rws1(server.url, LOGIN, timeouts=PATIENT, subscribe=False)
    with pytest.raises(ControllerReplyError, match="version"):
        link.read_ready()
    server.close()
    link.close()


@pytest.mark.parametrize("url", ["", "192.168.125.1", "ftp://x", "http://", "out/controller"])
def test_an_address_that_is_none(url: str) -> None:
    with pytest.raises(ConnectError, match="must be like"):
        connect_rws1(url, LOGIN)


def test_a_password_in_the_address_is_refused_and_not_repeated() -> None:
    with pytest.raises(ConnectError) as caught:
        connect_rws1("http://mill:zebra@192.168.125.1", LOGIN)
    assert "zebra" not in str(caught.value) + repr(caught.value.data)


def test_a_connection_closed_under_a_call_is_a_lost_connection(server: RwsServer) -> None:
    link = link_to(server)
    link.read_ready()
    link._http._client.close()
    with pytest.raises(ConnectionLostError):
        link.set_ready(True)
    link.close()


def test_nobody_there() -> None:
    with socket.socket() as bound:  # nobody else gets the port, and nobody listens on it
        bound.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{bound.getsockname()[1]}"
        link = connect_rws1(url, LOGIN, timeouts=PATIENT, subscribe=False)
        with pytest.raises(ConnectError, match="address"):
            link.read_ready()
        link.close()


def all_http_errors() -> list[type[httpx.HTTPError]]:
    found, todo = [], [httpx.HTTPError]
    while todo:
        kind = todo.pop()
        found.append(kind)
        todo.extend(kind.__subclasses__())
    return found


def test_every_error_of_the_http_library_has_a_leaf() -> None:
    request = httpx.Request("GET", "http://x")
    kinds = all_http_errors()
    assert len(kinds) >= 18
    for kind in kinds:
        error = (
            kind("m", request=request, response=httpx.Response(500))
            if kind is httpx.HTTPStatusError
            else kind("m")
        )
        mapped = map_http_error(error, "GET /x")
        assert isinstance(mapped, LinkError)
        if issubclass(kind, httpx.TimeoutException | httpx.NetworkError):
            assert not isinstance(mapped, ControllerReplyError), kind
        if issubclass(kind, httpx.ReadError | httpx.WriteError | httpx.WriteTimeout | httpx.ReadTimeout):
            assert mapped.in_doubt, kind


class TestCertificate:
    """Exactly one certificate is trusted."""

    @pytest.fixture
    def server2(self, tmp_path: Path):
        with RwsServer(Cabinet.create(tmp_path / "home"), 2) as running:
            yield running

    def test_another_certificate_is_refused(self, server2: RwsServer, tmp_path: Path) -> None:
        other, _ = write_certificate(tmp_path)
        link = connect_rws2(server2.url, LOGIN, certificate=other, timeouts=PATIENT, subscribe=False)
        with pytest.raises(CertificateError, match="not the pinned one"):
            link.read_ready()
        assert not server2.services.requests  # above all no password
        link.close()

    @pytest.mark.parametrize("days", [-400, 400])
    def test_the_pinned_one_is_trusted_whatever_the_clocks_say(self, tmp_path: Path, days: int) -> None:
        """One that has expired and one that is not good yet are the controller's all the same; no other one is."""
        ahead = days * 86400.0
        with RwsServer(Cabinet.create(tmp_path / "home"), 2, clock_ahead=ahead) as server:
            link = connect_rws2(server.url, LOGIN, certificate=server.certificate, timeouts=PATIENT)
            assert link.read_ready() is False
            until(lambda: link.events.live)
            link.close()
            server.services.requests.clear()
            other, _ = write_certificate(tmp_path, ahead)
            link = connect_rws2(server.url, LOGIN, certificate=other, timeouts=PATIENT, subscribe=False)
            with pytest.raises(CertificateError, match="not the pinned one"):
                link.read_ready()
            assert not server.services.requests
            link.close()

    def test_insecure_has_to_be_asked_for(self, server2: RwsServer, caplog: pytest.LogCaptureFixture) -> None:
        with pytest.raises(CertificateError):
            connect_rws2(server2.url, LOGIN)
        with pytest.raises(CertificateError):
            connect_rws2(server2.url, LOGIN, certificate=server2.certificate, insecure=True)
        link = connect_rws2(server2.url, LOGIN, insecure=True, timeouts=PATIENT)
        assert link.read_ready() is False
        assert "not checked" in caplog.text
        until(lambda: link.events.live)
        link.close()

    def test_the_one_saved_by_the_page_s_command_is_trusted(self, server2: RwsServer, tmp_path: Path) -> None:
        page = (ROOT / "docs" / "controller-link.md").read_text(encoding="utf-8")
        (command,) = re.findall(r"`(python3 -c [^`]*get_server_certificate[^`]*)`", page)
        port = str(urlsplit(server2.url).port)
        typed = command.replace("HOST", "127.0.0.1").replace("443", port)
        subprocess.run(["bash", "-c", typed], cwd=tmp_path, check=True, timeout=LIMIT)
        saved = tmp_path / "controller.pem"
        link = connect_rws2(server2.url, LOGIN, certificate=saved, timeouts=PATIENT, subscribe=False)
        assert link.read_ready() is False
        link.close()

    def test_no_certificate_in_the_file(self, tmp_path: Path) -> None:
        (tmp_path / "c.crt").write_text("nothing")
        with pytest.raises(CertificateError, match="PEM"):
            tls_context(tmp_path / "c.crt", insecure=False)


def test_dialects_spell_paths_as_documented() -> None:
    assert RWS1.file("Hei2.txt") == "/fileservice/$home/Hei2.txt"
    assert RWS2.file("Hei2.txt") == "/fileservice/HOME/Hei2.txt"
    assert RWS1.set_signal("doX") == "/rw/iosystem/signals/doX?action=set&json=1"
    assert RWS2.set_signal("Local/DRV_1/doX") == "/rw/iosystem/signals/Local/DRV_1/doX/set-value"
    assert (RWS1.subprotocol, RWS2.subprotocol) == ("robapi2_subscription", "rws_subscription")
    assert RWS1.error_code(b'{"_embedded": {"status": {"code": -1073414145}}}') == -1073414145
    assert RWS2.error_code(b"no json") == 0


def test_a_whole_handshake(listening: RwsTransport, server: RwsServer, tmp_path: Path) -> None:
    listening.in_doubt_time = 0.0
    handshake = Handshake(listening)
    handshake.on_start()

    def run_to(state: State) -> None:
        limit = time.monotonic() + LIMIT
        while handshake.snapshot.state is not state:
            assert time.monotonic() < limit, handshake.snapshot
            handshake.wait(0.05)
            handshake.step()

    run_to(State.IDLE)
    server.cabinet.set_value(signals.REQUEST, 1)
    run_to(State.REQUESTED)
    handshake.submit("run", "door", b"file" * 500)
    run_to(State.READY)
    assert (tmp_path / "Hei2.txt").read_bytes() == b"file" * 500
    assert (tmp_path / "Hei2.run").read_bytes() == b"run\n"
    assert server.cabinet.value(signals.READY) == 1
    server.cabinet.set_value(signals.REQUEST, 0)
    run_to(State.MILLING)
    assert server.cabinet.value(signals.READY) == 0
    assert not (tmp_path / "Hei2.txt").exists()
    server.cabinet.set_value(signals.DONE, 1)
    run_to(State.DONE)


def test_a_controller_that_appears_later(tmp_path: Path) -> None:
    later = RwsServer(Cabinet.create(tmp_path), 1)  # has its port, does not listen yet
    link = connect_rws1(later.url, LOGIN, timeouts=PATIENT, poll_interval=0.05)
    link.in_doubt_time = 0.0
    handshake = Handshake(link)
    assert handshake.on_start().state is State.CLEARING
    assert handshake.snapshot.error_code == ConnectError.code
    with later as server:
        server.cabinet.set_value(signals.READY, 1)
        (tmp_path / "Hei2.txt").write_bytes(b"left over")
        limit = time.monotonic() + LIMIT
        while handshake.snapshot.state is State.CLEARING:
            assert time.monotonic() < limit
            handshake.wait(0.05)
            handshake.step()
        assert server.cabinet.value(signals.READY) == 0
        assert not (tmp_path / "Hei2.txt").exists()
        handshake.close()
