"""One controller, however its address is written."""

from __future__ import annotations

import os
import socket
from pathlib import Path
from typing import Any

import pytest

from doormill_ros.abb import controller_names as module
from doormill_ros.abb.controller_names import controller_names

#: What the name server of these tests knows.
HOSTS = {
    "irc5.plant.example": ["192.0.2.17"],
    "robot": ["192.0.2.17", "2001:db8::17"],
    "192.0.2.17": ["192.0.2.17"],
    "192.0.2.18": ["192.0.2.18"],
    "2001:db8::17": ["2001:db8::17"],
    "2001:db8:0::17": ["2001:db8::17"],
    "::ffff:192.0.2.17": ["::ffff:192.0.2.17"],
    "localhost": ["::1", "127.0.0.1"],
    "127.0.0.1": ["127.0.0.1"],
    "127.0.1.1": ["127.0.1.1"],
    "::1": ["::1"],
    "0.0.0.0": ["0.0.0.0"],
    "192.0.2.99": ["192.0.2.99"],  # this machine's own
    "fe80::1%eth0": ["fe80::1%eth0"],
    "fe80::1%eth1": ["fe80::1%eth1"],
}


@pytest.fixture
def _network(monkeypatch: pytest.MonkeyPatch) -> None:
    def resolve(host: str, *_: object, **__: object) -> list[Any]:
        if host not in HOSTS:
            raise socket.gaierror(f"{host} is not known")
        return [(None, None, 0, "", (address, 0)) for address in HOSTS[host]]

    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    monkeypatch.setattr(socket, "gethostname", lambda: "this-pc")
    monkeypatch.setattr(module, "_is_own", lambda address: str(address) == "192.0.2.99")


def same(one: str, other: str) -> bool:
    return bool(set(controller_names(one)) & set(controller_names(other)))


@pytest.mark.usefixtures("_network")
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("http://localhost:8090", "http://127.0.0.1:8090"),
        ("http://localhost:8090", "http://[::1]:8090"),
        ("http://127.0.1.1:8090", "http://0.0.0.0:8090"),
        ("http://localhost:8090", "http://192.0.2.99:8090"),
        ("http://192.0.2.17", "http://192.0.2.17/"),
        ("http://192.0.2.17", "http://192.0.2.17:80"),
        ("https://192.0.2.17", "https://192.0.2.17:443/"),
        ("HTTP://IRC5.Plant.Example", "http://irc5.plant.example."),
        ("http://irc5.plant.example", "http://192.0.2.17"),
        ("http://robot", "http://192.0.2.17"),
        ("http://robot", "http://[2001:db8:0::17]"),
        ("http://[::ffff:192.0.2.17]", "http://192.0.2.17"),
        ("http://[fe80::1%eth0]", "http://[fe80::1%eth1]"),
        ("http://unknown.example/", "http://UNKNOWN.example:80"),
        (f"http://192.0.2.17/cell/{os.pardir}/irc5", "http://192.0.2.17/irc5/"),
    ],
)
def test_two_ways_to_write_one_controller(one: str, other: str) -> None:
    assert same(one, other), (controller_names(one), controller_names(other))


@pytest.mark.usefixtures("_network")
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("http://192.0.2.17", "http://192.0.2.18"),
        ("http://127.0.0.1:8090", "http://127.0.0.1:8091"),
        ("http://192.0.2.17/one", "http://192.0.2.17/two"),
        ("http://unknown.example", "http://other.example"),
        ("http://192.0.2.17", "out/controller/HOME"),
        ("http://robot:none", "http://robot"),
    ],
)
def test_two_controllers_are_two(one: str, other: str) -> None:
    assert not same(one, other), (controller_names(one), controller_names(other))


def test_a_folder_is_one_by_whatever_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "HOME"
    home.mkdir()
    (tmp_path / "link").symlink_to(home)
    monkeypatch.chdir(tmp_path)
    for way in ("HOME", "./HOME/", "link", str(tmp_path / "link" / os.pardir / "HOME"), str(home)):
        assert controller_names(way) == controller_names(str(home)), way
    assert not same("HOME", "other")


def test_an_own_address_is_found_by_the_system() -> None:
    assert same("http://127.0.0.1:8090", "http://localhost:8090")
    assert module._is_own(module.ipaddress.ip_address("127.0.0.1"))
    assert not module._is_own(module.ipaddress.ip_address("192.0.2.1"))  # for documents alone (RFC 5737)


@pytest.mark.usefixtures("_network")
def test_localhost_of_two_machines_is_two(monkeypatch: pytest.MonkeyPatch) -> None:
    here = controller_names("http://localhost:8090")
    assert here == ("this-pc:8090",)
    monkeypatch.setattr(socket, "gethostname", lambda: "other-pc")
    assert controller_names("http://localhost:8090") == ("other-pc:8090",)


@pytest.mark.usefixtures("_network")
def test_names_are_few_and_the_first_one_can_be_read() -> None:
    assert controller_names("http://robot/") == ("robot:80", "192.0.2.17:80", "2001:db8::17:80")
