"""The simulated web services against clients that know nothing of this project."""

from __future__ import annotations

import asyncio
import base64
import socket
import ssl
import threading
import time
from pathlib import Path

import httpx
import pytest
import requests
from abb_robot_client import rws as public
from rwswrap.RWS import RWS as RWS2
from websockets.asyncio.client import connect as connect_async
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.simulation.controller.cabinet.io_port import MemoryIo
from doormill_ros.simulation.controller.configuration.io_configuration import ACCESS_LEVELS
from doormill_ros.simulation.controller.rws_server.app import Behaviour
from doormill_ros.simulation.controller.rws_server.cabinet import (
    Cabinet,
    SimulatedSignal,
    default_signals,
)
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from doormill_ros.simulation.controller.rws_server.serving import serve
from doormill_ros.simulation.errors import WebServicesError
from support.waiting import LIMIT, until

USER, PASSWORD = "Default User", "robotics"
ACCEPT = {"Accept": "application/hal+json;v=2.0"}
FORM = {"Content-Type": "application/x-www-form-urlencoded;v=2.0"}
EXTRA = SimulatedSignal("doExtra", ACCESS_LEVELS["All"], "Local", "DRV_1")


@pytest.fixture
def server(tmp_path: Path):
    cabinet = Cabinet.create(tmp_path, (*default_signals(), EXTRA))
    cabinet.idle.data["DoorMill/nSpeed"] = "20"
    with RwsServer(cabinet, 1) as running:
        yield running


@pytest.fixture
def server2(tmp_path: Path):
    cabinet = Cabinet.create(tmp_path, (*default_signals(), EXTRA))
    cabinet.idle.data["DoorMill/nSpeed"] = "20"
    with RwsServer(cabinet, 2) as running:
        yield running


def digest(server: RwsServer) -> dict:
    return {"auth": requests.auth.HTTPDigestAuth(USER, PASSWORD), "timeout": 60}


class TestPublicClient:
    """abb_robot_client 0.4, written by others for real controllers, run unchanged."""

    def test_states(self, server: RwsServer) -> None:
        client = public.RWS(server.url)
        assert client.get_execution_state() == ("running", "forever")
        assert client.get_controller_state() == "motoron"
        assert client.get_operation_mode() == "AUTO"
        assert client.get_tasks()["T_ROB1"].motiontask
        client.stop()
        assert client.get_execution_state().ctrlexecstate == "stopped"
        client.resetpp()
        client.start()
        assert client.get_execution_state().ctrlexecstate == "running"
        with pytest.raises(public.ABBException):
            client.resetpp()
        client.close()
        assert not server.services.sessions.sessions

    def test_signals(self, server: RwsServer) -> None:
        client = public.RWS(server.url)
        for value in (1, 0, 1):
            client.set_digital_io("doExtra", value)
            assert client.get_digital_io("doExtra") == value
            assert server.cabinet.value("doExtra") == value
        client.close()

    def test_wrong_access_level(self, server: RwsServer) -> None:
        client = public.RWS(server.url)
        with pytest.raises(public.ABBException) as caught:
            client.set_digital_io(signals.REQUEST, 1)
        assert caught.value.code == -1073445881
        assert server.cabinet.value(signals.REQUEST) == 0
        client.close()

    def test_files(self, server: RwsServer, tmp_path: Path) -> None:
        client = public.RWS(server.url)
        data = bytes(range(256)) * 40
        client.upload_file("$home/Hei2.txt", data)
        assert (tmp_path / "Hei2.txt").read_bytes() == data
        assert client.read_file("$home/Hei2.txt") == data
        assert "Hei2.txt" in client.list_files("$home")
        client.delete_file("$home/Hei2.txt")
        with pytest.raises(Exception, match="File not found"):
            client.read_file("$home/Hei2.txt")
        client.close()

    def test_events_on_both_edges(self, server: RwsServer) -> None:
        client = public.RWS(server.url)
        events: list[object] = []
        kind, high = public.SubscriptionResourceType.Signal, public.SubscriptionResourcePriority.High
        subscription = client.subscribe(
            [public.SubscriptionResourceRequest(kind, high, "doExtra")], events.append
        )
        group = server.services.subscriptions.groups["1"]
        until(lambda: group.streams)
        for count, value in enumerate((1, 0, 1), start=1):
            server.cabinet.set_value("doExtra", value)
            until(lambda count=count: len(events) >= count)
        assert [event.lvalue for event in events] == ["1", "0", "1"]
        subscription.close()
        until(lambda: not group.streams)
        client.close()

    def test_rapid_data_while_nobody_else_holds_mastership(self, server: RwsServer) -> None:
        client, other = public.RWS(server.url), public.RWS(server.url)
        assert client.get_rapid_variable("DoorMill/nSpeed") == "20"
        client.set_rapid_variable("DoorMill/nSpeed", "21")
        assert client.get_rapid_variable("DoorMill/nSpeed") == "21"
        other._do_post("rw/mastership/rapid?action=request")
        with pytest.raises(public.ABBException) as caught:
            client.set_rapid_variable("DoorMill/nSpeed", "22")
        assert caught.value.code == -1073445862
        other.close()  # what a session held is free when it ends
        client.set_rapid_variable("DoorMill/nSpeed", "22")
        assert client.get_rapid_variable("DoorMill/nSpeed") == "22"
        client.close()

    def test_one_session_for_all(self, server: RwsServer) -> None:
        client = public.RWS(server.url)
        for _ in range(30):
            client.get_execution_state()
        assert server.services.sessions.created == 1
        client.close()


class TestPublicClient2:
    """rwswrap 0.1, written by others for a controller with RobotWare 7, run unchanged."""

    @pytest.fixture
    def client(self, server2: RwsServer) -> RWS2:
        return RWS2(server2.url, username=USER, password=PASSWORD, verify=str(server2.certificate))

    def test_execution(self, server2: RwsServer, client: RWS2) -> None:
        assert client.is_running()
        assert client.reset_pp().status_code == 403
        assert client.stop_RAPID().status_code == 204
        assert not client.is_running()
        assert client.reset_pp().status_code == 204
        assert client.toggle_motors(0).status_code == 204
        client.start_RAPID()
        assert not client.is_running()
        assert client.toggle_motors(1).status_code == 204
        client.start_RAPID()
        assert client.is_running()
        assert server2.services.sessions.created == 1

    def test_rapid_data_under_mastership(self, server2: RwsServer, client: RWS2) -> None:
        assert client.get_rapid_variable("nSpeed", module="DoorMill") == "20"
        assert client.set_rapid_variable("nSpeed", 21, module="DoorMill").status_code == 204
        assert client.get_rapid_variable("nSpeed", module="DoorMill") == "21"
        assert server2.cabinet.idle.data["DoorMill/nSpeed"] == "21"
        assert server2.services.operations.rights.holder() is None
        assert client.toggle_mastership(1).status_code == 204
        assert client.toggle_mastership(1).status_code == 403

    def test_a_wrong_password(self, server2: RwsServer) -> None:
        client = RWS2(server2.url, username=USER, password="x", verify=str(server2.certificate))
        assert client.get_exec_state().status_code == 401


class TestVersion1:
    """What the documentation of version 1.0 states."""

    def test_digest_challenge(self, server: RwsServer) -> None:
        answer = requests.get(f"{server.url}/rw/panel/opmode", timeout=LIMIT)
        assert answer.status_code == 401
        assert answer.headers["WWW-Authenticate"].startswith("Digest realm=")
        wrong = requests.get(
            f"{server.url}/rw/panel/opmode", auth=requests.auth.HTTPDigestAuth(USER, "x"), timeout=LIMIT
        )
        assert wrong.status_code == 401
        basic = requests.get(f"{server.url}/rw/panel/opmode", auth=(USER, PASSWORD), timeout=LIMIT)
        assert basic.status_code == 401

    def test_a_session_without_end_floods(self, server: RwsServer) -> None:
        server.services.sessions.limit = 5
        codes = [
            requests.get(f"{server.url}/rw/panel/opmode", **digest(server)).status_code for _ in range(7)
        ]
        assert codes == [200] * 5 + [503] * 2

    def test_idle_sessions_end(self, server: RwsServer) -> None:
        sessions = server.services.sessions
        client = requests.Session()
        client.auth = requests.auth.HTTPDigestAuth(USER, PASSWORD)
        assert client.get(f"{server.url}/rw/panel/opmode", timeout=LIMIT).status_code == 200
        idle_expiry, sessions.idle_expiry = sessions.idle_expiry, 0.02
        time.sleep(0.1)
        bare = requests.get(f"{server.url}/rw/panel/opmode", cookies=client.cookies, timeout=LIMIT)
        assert bare.status_code == 401
        sessions.idle_expiry = idle_expiry
        server.services.digest.forget()  # the client is told that its challenge is stale
        assert client.get(f"{server.url}/rw/panel/opmode", timeout=LIMIT).status_code == 200
        assert server.services.sessions.created == 2

    def test_the_dollar_is_literal(self, server: RwsServer, tmp_path: Path) -> None:
        (tmp_path / "a.txt").write_bytes(b"x")
        with httpx.Client(auth=httpx.DigestAuth(USER, PASSWORD), timeout=LIMIT) as client:
            assert client.get(f"{server.url}/fileservice/$home/a.txt").content == b"x"
            assert client.get(f"{server.url}/fileservice/%24home/a.txt").status_code == 400

    @pytest.mark.parametrize(
        "path", ["$home/../secret.txt", "$home/..%2fsecret.txt", "$home/%2e%2e/secret.txt"]
    )
    def test_nothing_outside_home(self, server: RwsServer, tmp_path: Path, path: str) -> None:
        (tmp_path.parent / "secret.txt").write_bytes(b"secret")
        host, port = "127.0.0.1", server.port
        with socket.create_connection((host, port), timeout=LIMIT) as raw:
            challenge = requests.get(server.url, timeout=LIMIT).headers["WWW-Authenticate"]
            auth = requests.auth.HTTPDigestAuth(USER, PASSWORD)
            auth.init_per_thread_state()
            auth._thread_local.chal = requests.utils.parse_dict_header(challenge.removeprefix("Digest "))
            header = auth.build_digest_header("GET", f"/fileservice/{path}")
            request = f"GET /fileservice/{path} HTTP/1.1\r\nHost: x\r\nAuthorization: {header}\r\n\r\n"
            raw.sendall(request.encode())
            answer = raw.recv(65536)
        assert b" 404 " in answer.split(b"\r\n")[0]
        assert b"secret" not in answer.split(b"\r\n\r\n")[1].replace(b"secret.txt", b"")

    def test_status_codes_of_the_file_service(self, server: RwsServer) -> None:
        with httpx.Client(
            auth=httpx.DigestAuth(USER, PASSWORD), base_url=server.url, timeout=LIMIT
        ) as client:
            assert client.put("/fileservice/$home/a.txt", content=b"1").status_code == 201
            assert client.put("/fileservice/$home/a.txt", content=b"2").status_code == 200
            assert client.delete("/fileservice/$home/a.txt").status_code == 204
            assert client.delete("/fileservice/$home/a.txt").status_code == 404
            body = {"fs-newname": "sub", "fs-action": "create"}
            assert client.post("/fileservice/$home", data=body).status_code == 201
            assert client.put("/fileservice/$home/none/a.txt", content=b"1").status_code == 404
            assert client.patch("/fileservice/$home/a.txt", content=b"1").status_code == 405

    def test_answers_are_xhtml_unless_json_is_asked_for(self, server: RwsServer) -> None:
        with httpx.Client(
            auth=httpx.DigestAuth(USER, PASSWORD), base_url=server.url, timeout=LIMIT
        ) as client:
            page = client.get(f"/rw/iosystem/signals/{signals.READY}").text
            assert '<span class="lvalue">0</span>' in page
            state = client.get(f"/rw/iosystem/signals/{signals.READY}?json=1").json()
            assert state["_embedded"]["_state"][0]["lvalue"] == "0"

    @pytest.mark.parametrize(
        ("body", "status"),
        [
            (f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=2", 201),
            (f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=3", 400),
            ("resources=1&1=/rw/iosystem/signals/none;state&1-p=1", 404),
            ("resources=1&1=/rw/cfg&1-p=1", 400),
            ("", 400),
        ],
    )
    def test_subscriptions(self, server: RwsServer, body: str, status: int) -> None:
        answer = requests.post(f"{server.url}/subscription", data=body, **digest(server))
        assert answer.status_code == status
        if status == 201:
            assert answer.headers["Location"] == f"ws://127.0.0.1:{server.port}/poll/1"

    @pytest.mark.parametrize(
        ("protocol", "with_cookie", "status"),
        [
            ("robapi2_subscription", True, 101),
            ("rws_subscription", True, 400),
            ("robapi2_subscription", False, 401),
        ],
    )
    def test_event_stream(self, server: RwsServer, protocol: str, with_cookie: bool, status: int) -> None:
        session = requests.Session()
        body = f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=2"
        session.post(f"{server.url}/subscription", data=body, **digest(server))
        cookies = "; ".join(f"{c.name}={c.value}" for c in session.cookies)
        headers = {"Cookie": cookies} if with_cookie else {}
        address = f"ws://127.0.0.1:{server.port}/poll/1"
        if status != 101:
            with pytest.raises(InvalidStatus) as caught:
                connect(address, subprotocols=[protocol], additional_headers=headers)
            assert caught.value.response.status_code == status
            return
        for _ in range(2):  # version 1.0 lets the address be used again
            with connect(address, subprotocols=[protocol], additional_headers=headers) as stream:
                level = 1 - server.cabinet.value(signals.REQUEST)
                server.cabinet.set_value(signals.REQUEST, level)
                assert f'<span class="lvalue">{level}</span>' in stream.recv(timeout=LIMIT)

    def test_pings(self, tmp_path: Path) -> None:
        with RwsServer(Cabinet.create(tmp_path), 1, ping_interval=0.05) as server:
            session = requests.Session()
            body = f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=2"
            session.post(f"{server.url}/subscription", data=body, **digest(server))
            cookies = "; ".join(f"{c.name}={c.value}" for c in session.cookies)
            pinged = threading.Event()
            with connect(
                f"ws://127.0.0.1:{server.port}/poll/1",
                subprotocols=["robapi2_subscription"],
                additional_headers={"Cookie": cookies},
            ) as stream:
                receive = stream.protocol.recv_frame

                def note(frame: object) -> None:
                    if frame.opcode == 9:
                        pinged.set()
                    receive(frame)

                stream.protocol.recv_frame = note
                assert pinged.wait(LIMIT)

    def test_too_many_requests(self, server: RwsServer) -> None:
        server.services.behaviour.requests_per_second = 2  # the first one takes two, for the challenge
        codes: list[int] = []
        with httpx.Client(
            auth=httpx.DigestAuth(USER, PASSWORD), base_url=server.url, timeout=LIMIT
        ) as client:
            until(lambda: codes.append(client.get("/rw/panel/opmode").status_code) or 503 in codes)
        assert codes[0] == 200
        assert set(codes) == {200, 503}


class TestVersion2:
    """Where version 2.0 differs."""

    @pytest.fixture
    def client(self, server2: RwsServer):
        context = ssl.create_default_context(cafile=str(server2.certificate))
        with httpx.Client(
            verify=context, base_url=server2.url, auth=(USER, PASSWORD), headers=ACCEPT, timeout=LIMIT
        ) as client:
            yield client

    def test_basic_once_then_the_cookie(self, server2: RwsServer, client: httpx.Client) -> None:
        assert client.get("/rw/panel/opmode").json()["state"][0]["opmode"] == "AUTO"
        client.auth = None
        assert client.get("/rw/panel/opmode").status_code == 200
        client.cookies.clear()
        assert client.get("/rw/panel/opmode").status_code == 401
        header = {"Authorization": "Basic " + base64.b64encode(b"Default User:x").decode()}
        assert client.get("/rw/panel/opmode", headers=header).status_code == 401

    def test_media_types(self, client: httpx.Client) -> None:
        assert client.get("/rw/panel/opmode", headers={"Accept": "application/json"}).status_code == 406
        path = f"/rw/iosystem/signals/{signals.READY}/set-value"
        plain = {"Content-Type": "application/x-www-form-urlencoded"}
        assert client.post(path, content="lvalue=1", headers=plain).status_code == 415
        assert client.post(path, content="lvalue=1", headers=FORM).status_code == 204
        upload = {"Content-Type": "text/plain"}
        assert client.put("/fileservice/HOME/a.txt", content=b"1", headers=upload).status_code == 415
        upload = {"Content-Type": "text/plain;v=2.0"}
        assert client.put("/fileservice/HOME/a.txt", content=b"1", headers=upload).status_code == 201
        xhtml = {"Accept": "application/xhtml+xml;v=2.0"}
        assert client.get("/fileservice/HOME/a.txt", headers=xhtml).status_code == 406
        assert client.get("/fileservice/HOME/a.txt", headers={"Accept": "*/*"}).content == b"1"

    def test_symbols_and_implicit_mastership(self, client: httpx.Client) -> None:
        path = "/rw/rapid/symbol/RAPID/T_ROB1/DoorMill/nSpeed/data"
        refused = client.post(path, content="value=21", headers=FORM)
        assert (refused.status_code, refused.json()["status"]["code"]) == (403, -1073445859)
        implicit = client.post(f"{path}?mastership=implicit", content="value=21", headers=FORM)
        assert implicit.status_code == 204
        assert client.get(path).json()["state"][0]["value"] == "21"

    def test_an_event_stream_is_spent_once_used(self, server2: RwsServer, client: httpx.Client) -> None:
        body = f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=2"
        answer = client.post("/subscription", content=body, headers=FORM)
        address = answer.headers["Location"]
        assert address == f"wss://127.0.0.1:{server2.port}/poll/1"
        options = {
            "ssl": ssl.create_default_context(cafile=str(server2.certificate)),
            "additional_headers": {"Cookie": "; ".join(f"{c.name}={c.value}" for c in client.cookies.jar)},
        }

        async def listen() -> None:
            # One thread alone may use a connection with TLS.
            with pytest.raises(InvalidStatus) as caught:
                await connect_async(address, subprotocols=["robapi2_subscription"], **options)
            assert caught.value.response.status_code == 400
            async with connect_async(address, subprotocols=["rws_subscription"], **options) as stream:
                server2.cabinet.set_value(signals.REQUEST, 1)
                assert '<span class="lvalue">1</span>' in await asyncio.wait_for(stream.recv(), 120)
            with pytest.raises(InvalidStatus):
                await connect_async(address, subprotocols=["rws_subscription"], **options)

        asyncio.run(listen())

    def test_two_subscriptions_at_once(self, server2: RwsServer, client: httpx.Client) -> None:
        server2.services.behaviour.subscription_time = 600.0
        client.get("/rw/panel/opmode")
        body = f"resources=1&1=/rw/iosystem/signals/{signals.REQUEST};state&1-p=2"
        codes: list[int] = []

        def subscribe() -> None:
            codes.append(client.post("/subscription", content=body, headers=FORM).status_code)

        first = threading.Thread(target=subscribe)
        first.start()
        until(lambda: server2.services._subscribing)
        subscribe()
        assert codes == [500]
        server2.services.behaviour.subscription_time = 0.0
        first.join()
        assert codes == [500, 201]


def test_a_change_by_another_process_on_the_same_folder_is_an_event(tmp_path: Path) -> None:
    """The robot program may run elsewhere on the folder; `Behaviour` is the default one."""
    cabinet = Cabinet.create(tmp_path)
    with RwsServer(cabinet, 1, behaviour=Behaviour()) as server:
        session = requests.Session()
        body = f"resources=1&1=/rw/iosystem/signals/{signals.DONE};state&1-p=1"
        session.post(f"{server.url}/subscription", data=body, **digest(server))
        cookies = "; ".join(f"{c.name}={c.value}" for c in session.cookies)
        with connect(
            f"ws://127.0.0.1:{server.port}/poll/1",
            subprotocols=["robapi2_subscription"],
            additional_headers={"Cookie": cookies},
        ) as stream:
            (tmp_path / "io" / signals.DONE).write_bytes(b"1")
            assert "lvalue" in stream.recv(timeout=LIMIT)


class TestServe:
    """By the name of the transport, as the simulated controller's parameter has it."""

    def test_nothing_without_a_name(self, tmp_path: Path) -> None:
        assert serve("", Cabinet.create(tmp_path), 0, tmp_path) is None

    @pytest.mark.parametrize(("name", "scheme"), [("rws1", "http://"), ("rws2", "https://")])
    def test_by_name(self, tmp_path: Path, name: str, scheme: str) -> None:
        folder = tmp_path / "certificates"
        running = serve(name, Cabinet.create(tmp_path / "HOME"), 0, folder)
        assert running is not None
        assert running.url.startswith(scheme)
        assert (folder / "controller.crt").exists() == (name == "rws2")
        running.stop()

    def test_another_name(self, tmp_path: Path) -> None:
        with pytest.raises(UnknownTransportError, match="'rws3', allowed are rws1, rws2"):
            serve("rws3", Cabinet.create(tmp_path), 0, tmp_path)

    def test_a_port_that_is_taken(self, tmp_path: Path) -> None:
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            with pytest.raises(WebServicesError, match="choose others"):
                serve("rws1", Cabinet.create(tmp_path), other.getsockname()[1], tmp_path)


def test_a_program_and_the_services_meet_on_one_port(tmp_path: Path) -> None:
    """No folder between them: the simulated controller and its web services share the `IoPort`."""
    io = MemoryIo()
    # The public client asks for signals of this device alone.
    table = [SimulatedSignal(s.name, s.access, "Local", "DRV_1") for s in default_signals()]
    with RwsServer(Cabinet.create(tmp_path, table, io), 1) as server:
        client = public.RWS(server.url)
        io.write(signals.REQUEST, 1)
        assert client.get_digital_io(signals.REQUEST) == 1
        client.set_digital_io(signals.READY, 1)
        assert io.read(signals.READY) == 1
        client.close()
    assert not (tmp_path / "io").exists()
