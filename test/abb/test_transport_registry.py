"""A new transport is one file and one line of the registry; nothing else of the project knows it."""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from pathlib import Path

import pytest

import doormill_ros
from doormill_ros.abb import signals
from doormill_ros.abb.credentials import PASSWORD_VARIABLE, USER_VARIABLE
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.abb.signal_paths import signal_paths
from doormill_ros.abb.transport_kind import ANSWER, TransportKind, TransportOptions
from doormill_ros.abb.transports.registry import TRANSPORTS, addresses, open_transport, users_of
from doormill_ros.abb.transports.rws_http import LinkTimeouts
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.cell.errors import BadParameterError
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet, default_signals
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.memory_transport import MemoryTransport
from support.web_services import LOGIN

PACKAGE = Path(doormill_ros.__file__).parent
FILE = b"1;2;3;1;0;0;0;0;0;0;0;\n" * 14


def test_one_line_makes_a_transport_usable_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[TransportOptions] = []

    def connect(options: TransportOptions) -> MemoryTransport:
        asked.append(options)
        return MemoryTransport()

    monkeypatch.setitem(TRANSPORTS, "memory", TransportKind(connect, "name", uses=("insecure",)))
    options = TransportOptions("anywhere")
    transport = open_transport("memory", options)
    assert asked == [options]
    handshake = Handshake(transport)
    handshake.on_start()
    transport.set_signal(signals.REQUEST, True)
    assert handshake.step().state is HandshakeState.REQUESTED
    handshake.submit("run_1", "door_1", FILE)
    assert handshake.step().state is HandshakeState.READY
    assert transport.read_file(signals.TARGET_FILE) == FILE
    with pytest.raises(UnknownTransportError, match="allowed are simulated_folder, rws1, rws2, memory"):
        open_transport("carrier", options)
    with pytest.raises(UnknownTransportError, match="or rws1, rws2 or memory for a real controller"):
        open_transport("shared_folder", options)
    assert addresses() == "HOME of simulated_folder, URL of rws1 and rws2, name of memory"
    assert users_of("insecure") == "rws2 and memory"
    assert users_of("manual_mode") == "rws1 and rws2"


def test_who_says_how_long_an_answer_takes_is_waited_for_so_long(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Limits reach the folder and the web services; nothing here waits for them to pass."""
    folder = open_transport("simulated_folder", TransportOptions(str(tmp_path), answer=77.0))
    assert isinstance(folder, SimulatedFolderTransport)
    assert folder._timeout == 77.0
    folder.close()
    monkeypatch.setenv(USER_VARIABLE, "mill")
    monkeypatch.setenv(PASSWORD_VARIABLE, "turns")
    for name, address in (("rws1", "http://127.0.0.1:1"), ("rws2", "https://127.0.0.1:1")):
        link = open_transport(name, TransportOptions(address, insecure=True, answer=77.0))
        assert link.in_doubt_time == 77.0
        link.close()


@pytest.mark.parametrize(("name", "scheme"), [("rws1", "http"), ("rws2", "https")])
def test_signals_of_a_device_are_asked_for_where_they_are(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, scheme: str
) -> None:
    """Over the registry, as the bridge opens it."""
    monkeypatch.setenv(USER_VARIABLE, LOGIN.user)
    monkeypatch.setenv(PASSWORD_VARIABLE, LOGIN.reveal())
    cabinet = Cabinet.create(tmp_path)
    cabinet.signals = {s.name: replace(s, network="Local", device="DRV_1") for s in default_signals()}
    paths = signal_paths(" ".join(f"Local/DRV_1/{signal}" for signal in signals.ALL_SIGNALS))
    with RwsServer(cabinet, int(name[-1])) as server:
        assert server.url.startswith(f"{scheme}:")
        for known, asked in (({}, "signals/doPathReady"), (paths, "signals/Local/DRV_1/doPathReady")):
            server.services.requests.clear()
            link = open_transport(name, TransportOptions(server.url, insecure=True, signal_paths=known))
            assert link.read_ready() is False
            link.close()
            assert any(asked in str(request) for request in server.services.requests), (
                server.services.requests
            )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("aiSpindleLoad", "has 'aiSpindleLoad', allowed is NETWORK/DEVICE/NAME"),
        ("a//aiSpindleLoad", "allowed is NETWORK/DEVICE/NAME"),
        ("a/b/c/aiSpindleLoad", "allowed is NETWORK/DEVICE/NAME"),
        ("a/b/aiSpindleload", "names aiSpindleload in 'a/b/aiSpindleload', allowed is each of aiSpindleLoad"),
        ("a/b/doPathBusy c/d/doPathBusy", "names doPathBusy twice"),
    ],
)
def test_paths_of_signals_that_cannot_be_are_refused(text: str, said: str) -> None:
    with pytest.raises(BadParameterError, match=re.escape(said)):
        signal_paths(text)


def test_no_paths_of_signals_are_none() -> None:
    assert signal_paths("  ") == {}


def test_an_answer_takes_over_the_web_services_what_it_did() -> None:
    assert LinkTimeouts.within(ANSWER) == LinkTimeouts()


def test_the_former_name_of_the_folder_is_refused_with_the_new_one() -> None:
    with pytest.raises(UnknownTransportError, match=r"'simulated_folder' now.*rws1 or rws2"):
        open_transport("shared_folder", TransportOptions("anywhere"))


def test_only_the_registry_names_the_transports() -> None:
    """No other room imports a transport's file; the simulated controller serves, it does not connect."""
    room = "doormill_ros.abb.transports"
    importers: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        if path.parent == PACKAGE / "abb" / "transports":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(room):
                importers.setdefault(node.module or "", set()).add(path.name)
    assert set(importers) == {f"{room}.registry"}
    assert importers[f"{room}.registry"] == {"abb_bridge.py"}
