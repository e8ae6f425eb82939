"""One kept web session with a controller: login, cookies, limits on time, errors named by phase."""

from __future__ import annotations

import contextlib
import socket
import ssl
import time
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from typing import Any

import httpx

from doormill_ros.abb.backoff import Backoff
from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.link_errors import (
    CertificateError,
    ConnectError,
    ConnectionLostError,
    ConnectTimeoutError,
    ControllerBusyError,
    ControllerReplyError,
    LinkError,
    LoginError,
    ReadTimeoutError,
    SessionExpiredError,
    WriteTimeoutError,
)
from doormill_ros.abb.transports.bounded import BoundedCaller, CallTimeout
from doormill_ros.abb.transports.rws_address import check_url
from doormill_ros.abb.transports.rws_answer import BoundedTransport
from doormill_ros.abb.transports.rws_pace import SPAN, RequestPace

_BUSY_FIRST = 0.05
_BUSY_LAST = 1.0
_CLOSE_LIMIT = 1.0
_TRIES = 2  # requests that one exchange may take
_LOGIN_PATH = "/rw/panel/opmode"  # any resource that can be read brings a session


@dataclass(frozen=True)
class LinkTimeouts:
    """Limits of one operation, by phase [s].

    Attributes:
        connect: To accept the connection.
        read: Between two pieces of the answer.
        write: Between two pieces of the request.
        total: For the whole operation, repetitions on "busy" included.
    """

    connect: float = 2.0
    read: float = 2.0
    write: float = 2.0
    total: float = 4.0

    @classmethod
    def within(cls, total: float) -> LinkTimeouts:
        """Limits of an operation that may take `total` [s], and half of that in any of its phases."""
        return cls(total / 2, total / 2, total / 2, total)


class RwsHttp:
    """Sends requests one after the other within one session; safe to use from several threads."""

    def __init__(
        self,
        url: str,
        credentials: Credentials,
        timeouts: LinkTimeouts,
        digest: bool,
        headers: dict[str, str],
        tls: ssl.SSLContext | None = None,
    ) -> None:
        """Prepare the session; nothing is sent.

        Args:
            url: Address of the controller, "http://192.168.125.1" for example.
            credentials: Account.
            timeouts: Limits.
            digest: HTTP digest (1.0) instead of basic authentication (2.0).
            headers: Sent with every request.
            tls: Trust for https.

        Raises:
            ConnectError: The address is no address.
        """
        self.url = check_url(url)
        self.tls = tls
        self._credentials = credentials
        self._timeouts = timeouts
        self._digest = digest
        self._headers = headers
        self._cookies = httpx.Cookies()
        self._stream: Any = None  # what the worker's connection runs over
        self._spent: list[httpx.Client] = []
        self._pace = RequestPace()
        self._client = self._new_client()
        self._worker = BoundedCaller("rws-http")
        self._logged_in = False

    def cookie_header(self) -> str:
        """The session's cookies, for the event stream."""
        return "; ".join(f"{cookie.name}={cookie.value}" for cookie in self._client.cookies.jar)

    def request(
        self,
        method: str,
        path: str,
        *,
        content: bytes | str | None = None,
        headers: dict[str, str] | None = None,
        repeat: bool = False,
        once: bool = False,
    ) -> httpx.Response:
        """Send and wait for the whole answer, at most `total` seconds once it is this request's turn.

        Args:
            method: HTTP verb.
            path: From "/" on, as it shall appear on the wire.
            content: Body.
            headers: In addition.
            repeat: Send once more when the connection breaks; only where twice or late does no harm.
            once: Send a single time: neither "log in" (401) nor "busy" (503) lets it be sent again.

        Returns:
            The answer, whatever its status except 401 and 503.

        Raises:
            LinkError: The leaf of the phase that failed.
        """

        def send() -> httpx.Response:
            self._pace.wait(_TRIES)  # before the clock of the operation starts; what it repeats waits again
            deadline = time.monotonic() + self._timeouts.total
            if once:
                return self._send_once(method, path, content, headers or {}, deadline)
            return self._send(method, path, content, headers or {}, repeat, deadline)

        try:
            return self._worker.call(send, self._timeouts.total + SPAN)
        except CallTimeout:
            self._renew_client()
            leaf = ReadTimeoutError if method == "GET" else WriteTimeoutError
            raise leaf(
                f"{method} {path} at {self.url} took longer than {self._timeouts.total:g} s; "
                "check the network and the controller's load",
                timeout=self._timeouts.total,
            ) from None

    def close(self, logout: Callable[[], Any] | None = None) -> None:
        """Run `logout` if there is a session, then close; raises nothing."""
        if self._logged_in and logout is not None:
            with contextlib.suppress(LinkError):
                logout()
        self._logged_in = False
        self._cut()
        self._spent.append(self._client)
        with contextlib.suppress(CallTimeout):
            self._worker.call(self._close_spent, _CLOSE_LIMIT)
        self._worker.close()

    def _send(
        self, method: str, path: str, content: Any, headers: dict[str, str], repeat: bool, deadline: float
    ) -> httpx.Response:
        self._close_spent()
        logins, losses, backoff = 0, 0, Backoff(time.monotonic, _BUSY_FIRST, _BUSY_LAST)
        while True:
            try:
                response = self._exchange(method, path, content, headers, deadline)
            except ConnectionLostError:
                losses += 1
                # What its caller has given up must not be sent any more.
                if not repeat or losses > 1 or time.monotonic() > deadline:
                    raise
                continue
            if response.status_code == 401:
                logins += 1
                if (
                    logins > 1 or self._digest or time.monotonic() > deadline
                ):  # httpx has answered the digest challenge already
                    raise LoginError(
                        f"controller {self.url} refuses user {self._credentials.user!r} (401); "
                        "check name and password and the user's grants",
                        url=self.url,
                    )
                self._logged_in = False
                self._client.cookies.clear()
                continue
            if response.status_code != 503:
                self._logged_in, self._fresh = True, False
                return response
            pause = backoff.failed()
            if time.monotonic() + pause >= deadline:
                raise ControllerBusyError(
                    f"controller {self.url} answers 503 to {method} {path}: too many sessions or requests; "
                    "close other clients, idle sessions end after some minutes",
                    url=self.url,
                )
            time.sleep(pause)

    def _send_once(
        self, method: str, path: str, content: Any, headers: dict[str, str], deadline: float
    ) -> httpx.Response:
        if self._fresh or not self._logged_in:
            self._send("GET", _LOGIN_PATH, None, {}, True, deadline)
        response = self._exchange(method, path, content, headers, deadline, answer_challenge=False)
        if response.status_code == 401:
            self._logged_in = False
            self._client.cookies.clear()
            raise SessionExpiredError(
                f"controller {self.url} had ended the session before {method} {path}; look at it again and repeat",
                url=self.url,
            )
        if response.status_code == 503:
            raise ControllerBusyError(
                f"controller {self.url} answers 503 to {method} {path}: too many sessions or requests; "
                "close other clients",
                url=self.url,
            )
        return response

    def _exchange(
        self,
        method: str,
        path: str,
        content: Any,
        headers: dict[str, str],
        deadline: float,
        answer_challenge: bool = True,
    ) -> httpx.Response:
        password = self._credentials.reveal
        auth: httpx.Auth | None = None
        if self._digest:
            auth = self._digest_auth if answer_challenge else _Unanswered(self._digest_auth)
        elif not self._logged_in:
            auth = httpx.BasicAuth(self._credentials.user, password())
        doing = f"{method} {path} at {self.url}"
        # A digest login is asked for and then answered.
        self._pace.wait(_TRIES)
        if time.monotonic() > deadline:  # likewise
            raise ControllerBusyError(
                f"{doing}: too many requests before it; close other clients", url=self.url
            )
        sent = _TRIES
        try:
            response = self._client.request(
                method,
                self.url + path,
                content=content,
                headers=headers,
                auth=auth,
                extensions={"trace": self._note_stream},
            )
            sent = 1 + len(response.history)
        except httpx.HTTPError as error:
            raise map_http_error(error, doing) from None
        except (RuntimeError, OSError, ValueError) as error:
            # What the libraries raise when another thread cut the connection to end a call that hung.
            raise ConnectionLostError(
                f"{doing}: the connection was given up ({type(error).__name__}); check the network"
            ) from None
        finally:
            self._pace.answered(sent)
        return response

    def _new_client(self) -> httpx.Client:
        limits = self._timeouts
        # Made anew with the client: it keeps the last challenge, which dies with a restarted controller.
        self._digest_auth = httpx.DigestAuth(self._credentials.user, self._credentials.reveal())
        self._fresh = True
        return httpx.Client(
            cookies=self._cookies,
            headers={"Accept-Encoding": "identity"} | self._headers,
            timeout=httpx.Timeout(limits.read, connect=limits.connect, write=limits.write),
            transport=BoundedTransport(
                verify=self.tls if self.tls is not None else True,
                limits=httpx.Limits(max_connections=1),
                trust_env=False,
            ),
            trust_env=False,  # no proxies and no .netrc between the PC and its robot
            follow_redirects=False,
        )

    def _renew_client(self) -> None:
        """End the call that hangs and begin anew; the session's cookies live on."""
        self._cut()
        self._spent.append(self._client)
        self._cookies = httpx.Cookies(self._client.cookies)
        self._client = self._new_client()

    def _note_stream(self, event: str, info: Mapping[str, Any]) -> None:
        if event.endswith((".connect_tcp.complete", ".start_tls.complete")):
            self._stream = info["return_value"]

    def _cut(self) -> None:
        """Let whoever reads or writes the connection find it ended.

        Closed it is by the worker alone, once it is out of the call: a socket closed under a
        reader gives its number to the next one opened, whose bytes the reader would then take.
        """
        stream, self._stream = self._stream, None
        if stream is not None:
            with contextlib.suppress(OSError):
                # Of the socket beneath: the one with TLS would drop the state that the worker uses.
                socket.socket.shutdown(stream.get_extra_info("socket"), socket.SHUT_RDWR)

    def _close_spent(self) -> None:
        while self._spent:
            with contextlib.suppress(Exception):
                self._spent.pop().close()


class _Unanswered(httpx.Auth):
    """Signs a request with the last challenge; a new one is not answered by sending it again."""

    def __init__(self, digest: httpx.DigestAuth) -> None:
        self._digest = digest

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response, None]:
        yield next(self._digest.auth_flow(request))


def map_http_error(error: httpx.HTTPError, doing: str) -> LinkError:
    """The leaf that says in which phase an HTTP exchange failed.

    Args:
        error: What httpx raised.
        doing: The operation, for the message.
    """
    reason = str(error) or type(error).__name__
    if isinstance(error, httpx.ConnectTimeout | httpx.PoolTimeout):
        return ConnectTimeoutError(f"{doing}: no connection in time; check cable, address and firewall")
    if isinstance(error, httpx.ConnectError):
        if "CERTIFICATE" in reason.upper() or "SSL" in reason.upper():
            return CertificateError(
                f"{doing}: the controller's certificate is not the pinned one ({reason}); if it was renewed "
                "on purpose, export it again"
            )
        return ConnectError(f"{doing}: {reason}; check that the controller runs and the address is right")
    if isinstance(error, httpx.UnsupportedProtocol):
        return ConnectError(f"{doing}: {reason}; the address must begin with http:// or https://")
    if isinstance(error, httpx.TimeoutException) and not isinstance(error, httpx.WriteTimeout):
        return ReadTimeoutError(f"{doing}: no answer in time; check the network and the controller's load")
    if isinstance(error, httpx.WriteTimeout):
        return WriteTimeoutError(f"{doing}: the controller did not take the data in time; check the network")
    if isinstance(error, httpx.NetworkError | httpx.RemoteProtocolError):
        return ConnectionLostError(f"{doing}: the connection broke ({reason}); check the network")
    return ControllerReplyError(f"{doing}: {reason}; the answer is not what the protocol foresees")
