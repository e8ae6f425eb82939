"""The simulated web services as an ASGI application: login, sessions, dialect, event streams."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import secrets
import time
from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote

from starlette.requests import Request
from starlette.responses import Response
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.dialect import RWS1_ROUTES, RWS2_ROUTES, RwsCall, dispatch
from doormill_ros.simulation.controller.rws_server.events import Group, Subscriptions
from doormill_ros.simulation.controller.rws_server.operations import Operations
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    Item,
    RefusalError,
    json_body,
    json_error,
    xhtml,
    xhtml_error,
)
from doormill_ros.simulation.controller.rws_server.sessions import (
    ABB_COOKIE,
    SESSION_COOKIE,
    DigestGate,
    Session,
    SessionTable,
)

_SUBPROTOCOLS = {1: "robapi2_subscription", 2: "rws_subscription"}
_XHTML2 = "application/xhtml+xml;v=2.0"
_HAL2 = "application/hal+json;v=2.0"


@dataclass
class Behaviour:
    """How the simulated controller treats its clients.

    Attributes:
        user: Account name.
        password: Account password.
        session_limit: Sessions at a time; 70 on IRC5, fewer on OmniCore.
        idle_expiry: Idle life of a session and of a challenge [s].
        requests_per_second: More are answered 503; None for no limit.
        delay: Added to every answer [s].
        subscription_time: How long a subscription takes; a second one meanwhile gets 500 in 2.0 [s].
    """

    user: str = "Default User"
    password: str = "robotics"
    session_limit: int = 70
    idle_expiry: float = 300.0
    requests_per_second: float | None = None
    delay: float = 0.0
    subscription_time: float = 0.005


class WebServices:
    """One controller's web services of version 1 or 2."""

    def __init__(
        self, cabinet: Cabinet, version: int, base: str, behaviour: Behaviour, robotware: int = 0
    ) -> None:
        """Make the application.

        Args:
            cabinet: What it gives access to.
            version: 1 or 2.
            base: Absolute address, for example "http://127.0.0.1:8080/".
            behaviour: How it treats clients; may be changed while running.
            robotware: Major version of RobotWare; 0 for the one that goes with `version`.
        """
        self.behaviour = behaviour
        self.sessions = SessionTable(behaviour.session_limit, behaviour.idle_expiry)
        self.digest = DigestGate(behaviour.user, behaviour.password, behaviour.idle_expiry)
        self.operations = Operations(cabinet, version, self._is_alive, robotware)
        self.subscriptions = Subscriptions(self.operations, base)
        self.requests: list[tuple[str, str, int]] = []
        self._version = version
        self._base = base
        self._routes = RWS1_ROUTES if version == 1 else RWS2_ROUTES
        self._subscribing = False
        self._recent: list[float] = []

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI entry."""
        if scope["type"] == "http":
            await self._http(Request(scope, receive), scope, receive, send)
        elif scope["type"] == "websocket":
            await self._stream(WebSocket(scope, receive, send))

    async def _http(self, request: Request, scope: Scope, receive: Receive, send: Send) -> None:
        if self.behaviour.delay:
            await asyncio.sleep(self.behaviour.delay)
        body = await request.body()
        session, response = self._admit(request)
        if session is not None:
            try:
                response = await self._answer(request, session, body)
            except RefusalError as error:
                response = self._refusal(request, error)
            if SESSION_COOKIE not in request.cookies or request.cookies[SESSION_COOKIE] != session.token:
                for name, value in ((SESSION_COOKIE, session.token), (ABB_COOKIE, session.number)):
                    response.headers.append("Set-Cookie", f"{name}={value}; path=/; httponly")
        self.requests.append((request.method, scope["raw_path"].decode(), response.status_code))
        await response(scope, receive, send)

    # Admission -------------------------------------------------------------------------------------

    def _admit(self, request: Request) -> tuple[Session | None, Response]:
        if self._too_fast():
            return None, Response("Service Unavailable", 503)
        session = self.sessions.find(request.cookies)
        authorized, stale = self._authorized(request)
        if session is None and not authorized:
            name = (
                self.digest.challenge(stale) if self._version == 1 else 'Basic realm="validusers@robapi.abb"'
            )
            return None, Response("Unauthorized", 401, headers={"WWW-Authenticate": name})
        if session is None:
            session = self.sessions.create()
        if session is None:
            return None, Response("Service Unavailable", 503)
        return session, Response(status_code=204)

    def _authorized(self, request: Request | WebSocket) -> tuple[bool, bool]:
        header = request.headers.get("authorization", "")
        if self._version == 1:
            return self.digest.check(header, getattr(request, "method", "GET"))
        wanted = base64.b64encode(f"{self.behaviour.user}:{self.behaviour.password}".encode()).decode()
        return secrets.compare_digest(header.encode(), f"Basic {wanted}".encode()), False

    def _too_fast(self) -> bool:
        limit, now = self.behaviour.requests_per_second, time.monotonic()
        if limit is None:
            return False
        self._recent = [t for t in self._recent if now - t < 1.0]
        if len(self._recent) >= limit:
            return True
        self._recent.append(now)
        return False

    # Requests --------------------------------------------------------------------------------------

    async def _answer(self, request: Request, session: Session, body: bytes) -> Response:
        raw_path = request.scope["raw_path"].decode("latin-1")
        if self._version == 1 and "%24" in raw_path:
            raise RefusalError(400, CODE_INVALID, "'$' must not be percent-encoded")
        path = unquote(raw_path).lstrip("/")
        if not path.startswith("fileservice/"):
            path = path.rstrip("/")
        if self._version == 2:
            self._check_media_types(request, path)
        form = [] if request.method == "PUT" else parse_qsl(body.decode("latin-1"), keep_blank_values=True)
        if path == "subscription" and request.method == "POST":
            return await self._subscribe(request, session, form)
        if path.startswith("subscription/") and request.method == "DELETE":
            self.subscriptions.delete(path.split("/")[1])
            return Response(status_code=200)
        if path == "logout":
            self.sessions.end(session)
            return Response(status_code=200, media_type="text/plain")
        newest_first = "v=2.1" in request.headers.get("accept", "")
        call = RwsCall(
            request.method, path, dict(request.query_params), dict(form), body, session.token, newest_first
        )
        answer = dispatch(self._routes, self.operations, call)
        if answer.raw is not None:
            return Response(answer.raw, answer.status, media_type="application/octet-stream")
        if answer.status != 200 or request.method == "PUT":
            return Response(status_code=answer.status, media_type="text/plain")
        return self._listing(request, list(answer.items))

    def _check_media_types(self, request: Request, path: str) -> None:
        accept, content = request.headers.get("accept", "*/*"), request.headers.get("content-type", "")
        if request.method != "GET" and not (content and "content-length" in request.headers):
            # Seen on controllers: any change without both headers, an empty one too.
            raise RefusalError(406, CODE_INVALID, "Content-Type and Content-Length are missing")
        is_file = path.startswith("fileservice/") and "." in path.rsplit("/", 1)[-1]
        if is_file and request.method == "GET":
            if accept.startswith("application/xhtml"):
                raise RefusalError(406, CODE_INVALID, "a file is not XHTML")
        elif "*/*" not in accept and "v=2.0" not in accept and not ("v=2.1" in accept and "rw/elog" in path):
            raise RefusalError(406, CODE_INVALID, "Accept lacks v=2.0")
        if request.method == "PUT" and content not in ("text/plain;v=2.0", "application/octet-stream;v=2.0"):
            raise RefusalError(415, CODE_INVALID, f"Content-Type {content!r}")
        if request.method == "POST" and content != "application/x-www-form-urlencoded;v=2.0":
            raise RefusalError(415, CODE_INVALID, f"Content-Type {content!r}")

    def _listing(self, request: Request, items: list[Item]) -> Response:
        if self._wants_json(request):
            media = "application/json" if self._version == 1 else _HAL2
            return Response(json_body(self._base, items, self._version), media_type=media)
        media = "application/xhtml+xml" if self._version == 1 else _XHTML2
        return Response(xhtml(self._base, items), media_type=media)

    def _refusal(self, request: Request, error: RefusalError) -> Response:
        is_file = "/fileservice/" in request.scope["path"]
        if self._version == 2 and is_file and error.status == 404:  # seen so on controllers, type and all
            return Response(json_error(self._base, error, 2), 404, media_type="text/html")
        if self._wants_json(request) and not (is_file and self._version == 1):
            media = "application/json" if self._version == 1 else _HAL2
            return Response(json_error(self._base, error, self._version), error.status, media_type=media)
        media = "application/xhtml+xml" if self._version == 1 else _XHTML2
        return Response(xhtml_error(self._base, error), error.status, media_type=media)

    def _wants_json(self, request: Request) -> bool:
        if self._version == 1:
            return request.query_params.get("json") == "1"
        return "hal+json" in request.headers.get("accept", "")

    def _is_alive(self, owner: str) -> bool:
        return owner in self.sessions.sessions

    # Events ------------------------------------------------------------------------------------------

    async def _subscribe(self, request: Request, session: Session, form: list[tuple[str, str]]) -> Response:
        if self._subscribing and self._version == 2:
            raise RefusalError(500, CODE_INVALID, "another subscription is being made")
        self._subscribing = True
        try:
            begun = time.monotonic()
            while time.monotonic() - begun < self.behaviour.subscription_time:
                await asyncio.sleep(0.002)
            keys = [value for key, value in form if key == "resources"]
            group = self.subscriptions.create(session, dict(form), keys)
        finally:
            self._subscribing = False
        host = request.headers.get("host", "127.0.0.1")
        stream = f"{'ws' if self._version == 1 else 'wss'}://{host}/poll/{group.number}"
        links = [(stream, "self"), (f"subscription/{group.number}", "group")]
        body = xhtml(self._base, self.subscriptions.items(group), links)
        return Response(body, 201, {"Location": stream}, media_type="application/xhtml+xml")

    async def _stream(self, socket: WebSocket) -> None:
        group = self.subscriptions.groups.get(socket.scope["path"].removeprefix("/poll/"))
        session = self.sessions.find(socket.cookies)
        protocol = _SUBPROTOCOLS[self._version]
        status = 101
        if session is None and not (self._version == 1 and self._authorized(socket)[0]):
            status = 401
        elif group is None or (group.spent and self._version == 2):
            status = 404
        elif protocol not in socket.scope["subprotocols"]:
            status = 400
        if status != 101 or group is None:
            await socket.send_denial_response(Response(status_code=status))
            return
        await self._feed(socket, group, protocol)

    async def _feed(self, socket: WebSocket, group: Group, protocol: str) -> None:
        queue: asyncio.Queue[bytes | None] = asyncio.Queue()
        group.streams.add(queue)  # before the client is let in: from then on it misses no edge
        group.spent = True
        group.session.sockets += 1
        reader: asyncio.Future[None] | None = None
        try:
            await socket.accept(protocol)
            reader = asyncio.ensure_future(_until_closed(socket, queue))
            while (event := await queue.get()) is not None:
                await socket.send_text(event.decode())
            with contextlib.suppress(RuntimeError):
                await socket.close(1001)
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            if reader is not None:
                reader.cancel()
            group.streams.discard(queue)
            group.session.sockets -= 1


async def _until_closed(socket: WebSocket, queue: asyncio.Queue[bytes | None]) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await socket.receive_text()
    queue.put_nowait(None)
