"""Status and return code of refusals, as controllers with RobotWare 6.16 and 7.21 answered them.

The captured answers stand in github.com/ichbinmeraj/abb-rws-client, tests/fixtures/errors.
"""

from __future__ import annotations

import ssl
from pathlib import Path

import httpx
import pytest

from doormill_ros.abb import signals
from doormill_ros.simulation.controller.operation.states import OperatingMode
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.running import served_cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.waiting import LIMIT

LOGIN = ("Default User", "robotics")
FORM = "application/x-www-form-urlencoded"
START = "regain=continue&execmode=continue&cycle=forever&condition=none&stopatbp=disabled&alltaskbytsp=false"


@pytest.fixture
def server(tmp_path: Path):
    with RwsServer(Cabinet.create(tmp_path), 1) as running:
        yield running


@pytest.fixture
def server2(tmp_path: Path):
    with RwsServer(Cabinet.create(tmp_path), 2) as running:
        yield running


def client1(server: RwsServer) -> httpx.Client:
    return httpx.Client(auth=httpx.DigestAuth(*LOGIN), base_url=server.url, timeout=LIMIT)


def client2(server: RwsServer) -> httpx.Client:
    headers = {"Accept": "application/hal+json;v=2.0"}
    trust = ssl.create_default_context(cafile=str(server.certificate))
    return httpx.Client(auth=LOGIN, base_url=server.url, headers=headers, verify=trust, timeout=LIMIT)


def post1(client: httpx.Client, path: str, body: str = "") -> tuple[int, int]:
    found = client.post(f"{path}&json=1", content=body, headers={"Content-Type": FORM})
    return found.status_code, found.json()["_embedded"]["status"]["code"]


def post2(client: httpx.Client, path: str, body: str = "") -> tuple[int, int]:
    found = client.post(path, content=body, headers={"Content-Type": f"{FORM};v=2.0"})
    return found.status_code, found.json()["status"]["code"]


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("/rw/iosystem/signals/NoSuchNet/NoSuchDev/NoSuchSig", 404, -1073445866),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/NoMod/noSym", 400, -1073414146),
        ("/rw/rapid/tasks/T_ROB1/modules/NoSuchModule", 404, -1073414146),
    ],
)
def test_nothing_there_1(server: RwsServer, path: str, status: int, code: int) -> None:
    with client1(server) as client:
        found = client.get(f"{path}?json=1")
    assert (found.status_code, found.json()["_embedded"]["status"]["code"]) == (status, code)


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("/rw/iosystem/signals/NoSuchNet/NoSuchDev/NoSuchSig", 404, -1073445866),
        ("/rw/rapid/symbol/RAPID/T_ROB1/BASE/no_such_var/data", 404, -1073442816),
        ("/rw/rapid/tasks/T_ROB1/modules/NoSuchModule", 400, -1073442813),
        ("/fileservice/NOVOL:/NO_SUCH", 400, -1073438716),
        ("/fileservice/HOME/no-such-file.modx", 404, -1073438713),
    ],
)
def test_nothing_there_2(server2: RwsServer, path: str, status: int, code: int) -> None:
    with client2(server2) as client:
        found = client.get(path)
    assert (found.status_code, found.json()["status"]["code"]) == (status, code)


def test_a_missing_file_is_told_in_xhtml_by_1_and_as_text_html_by_2(
    server: RwsServer, server2: RwsServer
) -> None:
    with client1(server) as client:
        first = client.get("/fileservice/$HOME/no-such-file.mod?json=1")
    assert (first.status_code, first.headers["Content-Type"]) == (404, "application/xhtml+xml")
    assert '<span class="code">-1073414146</span>' in first.text
    with client2(server2) as client:
        second = client.get("/fileservice/HOME/no-such-file.modx")
    assert second.headers["Content-Type"].startswith("text/html")


def test_access_and_operating_mode(server: RwsServer, server2: RwsServer) -> None:
    manual = OperatingMode.MANUAL_REDUCED
    with client1(server) as client:
        path = "/rw/iosystem/signals/{}?action=set"
        assert post1(client, path.format(signals.REQUEST), "lvalue=1") == (403, -1073445881)
        server.cabinet.idle.panel.set_mode(manual)
        assert post1(client, path.format(signals.READY), "lvalue=1") == (403, -1073445881)
    with client2(server2) as client:
        path = "/rw/iosystem/signals/{}/set-value"
        assert post2(client, path.format(signals.REQUEST), "lvalue=1") == (403, -1073445881)
        server2.cabinet.idle.panel.set_mode(manual)
        assert post2(client, path.format(signals.READY), "lvalue=1") == (403, -1073445881)
    assert server.cabinet.value(signals.READY) == server2.cabinet.value(signals.READY) == 0


@pytest.mark.parametrize(
    ("access", "automatic", "manual"),
    [
        ("All", True, True),
        ("Default", False, False),
        ("ReadOnly", False, False),
        ("Internal", False, False),
        ("-RemoteAuto", True, False),
        ("-RemoteManual", False, True),
        ("-LocalAuto -Rapid", False, False),
    ],
)
@pytest.mark.parametrize("version", [1, 2])
def test_a_client_writes_what_the_level_lets_a_remote_one_write(
    tmp_path: Path, controller, version: int, access: str, automatic: bool, manual: bool
) -> None:
    """Levels from an I/O configuration; in manual mode the operator has granted the privilege."""
    level = "" if access[0] != "-" else f'EIO_ACCESS:\n\n      -Name "Own" {access}\n#\n'
    name = access if access[0] != "-" else "Own"
    module = tmp_path / "idle.mod"
    module.write_text("MODULE idle\nPROC main()\nENDPROC\nENDMODULE\n")
    eio = tmp_path / "EIO.cfg"
    eio.write_text(
        f'EIO:CFG_1.0:6:1::\n{level}EIO_SIGNAL:\n\n      -Name "doX" -SignalType "DO" -Access "{name}"\n'
    )
    robot = controller(modules=[module], io_configuration=eio, expected_door=None)
    cabinet = served_cabinet(tmp_path, robot.io, lambda: robot)
    cabinet.answers_privilege = "GRANTED"
    post, client, path = {
        1: (post1, client1, "/rw/iosystem/signals/doX?action=set"),
        2: (post2, client2, "/rw/iosystem/signals/doX/set-value"),
    }[version]
    refused = (403, -1073445881)
    with RwsServer(cabinet, version) as running, client(running) as web:
        for mode, allowed in ((OperatingMode.AUTO, automatic), (OperatingMode.MANUAL_REDUCED, manual)):
            robot.panel.set_mode(mode)
            robot.cell.force("doX", 0.0)
            if mode is not OperatingMode.AUTO:
                headers = {"Content-Type": FORM + (";v=2.0" if version == 2 else "")}
                assert web.post("/users/rmmp", content="privilege=modify", headers=headers).status_code == 202
            if allowed:
                suffix, headers = ("&json=1", {"Content-Type": FORM + (";v=2.0" if version == 2 else "")})
                answer = web.post(path + suffix * (version == 1), content="lvalue=1", headers=headers)
                assert answer.status_code == 204
            else:
                assert post(web, path, "lvalue=1") == refused
            assert robot.read_signal("doX") == float(allowed)


def test_mastership(server: RwsServer, server2: RwsServer) -> None:
    with client1(server) as client, client1(server) as other:
        other.post("/rw/mastership/rapid?action=request", headers={"Content-Type": FORM})
        assert post1(client, "/rw/mastership/rapid?action=request") == (403, -1073445862)
    with client2(server2) as client, client2(server2) as other:
        speed = "/rw/panel/speedratio?action=setspeedratio"
        assert post2(client, speed, "speed-ratio=100") == (403, -1073445859)
        other.post("/rw/mastership/edit/request", headers={"Content-Type": f"{FORM};v=2.0"})
        assert post2(client, "/rw/mastership/edit/request") == (403, -1073445862)
        assert post2(client, "/rw/rapid/execution/start", START) == (403, -1073445862)


def test_a_start_in_the_wrong_state(server: RwsServer) -> None:
    with client1(server) as client:
        assert post1(client, "/rw/rapid/execution?action=start", START) == (400, -1073442809)


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE"])
def test_version_2_wants_a_content_type_even_of_nothing(server2: RwsServer, method: str) -> None:
    with client2(server2) as client:
        assert client.request(method, "/fileservice/HOME/a.txt").status_code == 406
