"""The request signal's edges as the controller reports them on an event stream.

Events come late, by some hundred milliseconds, and are lost with the connection; so they only make
the handshake look sooner, and it asks the controller itself before it acts.

The stream is read and written by one thread, in an event loop of its own: OpenSSL forbids two threads
on one connection, which a blocking client would be, and ends the process when it happens.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
import threading
import time
from collections import deque
from collections.abc import Callable
from urllib.parse import urlsplit

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

from doormill_ros.abb.backoff import Backoff
from doormill_ros.abb.link_errors import LinkError, SubscriptionError
from doormill_ros.abb.transports.rws_dialect import Dialect
from doormill_ros.abb.transports.rws_http import RwsHttp

_LOG = logging.getLogger(__name__)
# The library would log request headers, and with them cookies, when someone turns debugging on.
_SILENT = logging.Logger("doormill_ros.silent", level=logging.CRITICAL + 1)
_EVENT = re.compile(
    r'<a\s[^>]*href="/rw/iosystem/signals/([^"]+);state"[^>]*>.*?<span\s+class="lvalue">\s*([01])\s*<', re.S
)
_RETRY_FIRST = 0.2
_RETRY_LAST = 10.0
_OPEN_LIMIT = 5.0
_LONGEST = 65_536  # characters of a message; the pattern's time grows with their square


class RwsEvents:
    """Keeps one event stream alive from a thread and queues the edges it reports."""

    def __init__(self, http: RwsHttp, dialect: Dialect, signal_path: str, woken: threading.Event) -> None:
        """Prepare; `start` connects.

        Args:
            http: The session.
            dialect: Version of the web services.
            signal_path: `{name}` or `{network}/{device}/{name}` of the request signal.
            woken: Set at each edge and when the stream comes or goes.
        """
        self._http = http
        self._dialect = dialect
        self._path = signal_path
        self._woken = woken
        self._edges: deque[bool] = deque(maxlen=100)
        self._stop = threading.Event()
        self._end: Callable[[], object] | None = None  # ends the stream, from any thread
        self._group = ""
        self.live = False
        self._thread = threading.Thread(target=self._run, name="rws-events", daemon=True)

    def start(self) -> None:
        """Begin to connect."""
        self._thread.start()

    def next_edge(self) -> bool | None:
        """The oldest level not seen yet, None when there is none."""
        try:
            return self._edges.popleft()
        except IndexError:
            return None

    def close(self) -> None:
        """End the stream and the subscription; raises nothing."""
        self._stop.set()
        end = self._end
        if end is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended by itself
                end()
        if self._thread.is_alive():
            self._thread.join(_OPEN_LIMIT)
        self._unsubscribe()

    def _run(self) -> None:
        backoff = Backoff(time.monotonic, _RETRY_FIRST, _RETRY_LAST)
        while not self._stop.is_set():
            try:
                address = self._subscribe()
                asyncio.run(self._listen(address))
                backoff.reset()
            except (LinkError, WebSocketException, OSError, TimeoutError) as error:
                _LOG.warning("event stream of the controller: %s; signals are polled meanwhile", error)
            self._unsubscribe()
            self._stop.wait(backoff.failed())

    async def _listen(self, address: str) -> None:
        """Take what the stream brings until either side ends it."""
        loop, listening = asyncio.get_running_loop(), asyncio.ensure_future(self._take_events(address))
        self._end = lambda: loop.call_soon_threadsafe(listening.cancel)
        try:
            if self._stop.is_set():
                listening.cancel()
            await listening
        except asyncio.CancelledError:
            pass  # closed
        finally:
            self._end = None

    async def _take_events(self, address: str) -> None:
        async with connect(
            address,
            subprotocols=[self._dialect.subprotocol],
            additional_headers={"Cookie": self._http.cookie_header()},
            ssl=self._http.tls,
            open_timeout=_OPEN_LIMIT,
            close_timeout=1.0,
            ping_interval=None,  # the controller pings; whether it answers pings is not documented
            proxy=None,
            max_size=_LONGEST,
            logger=_SILENT,
        ) as socket:
            self.live = True
            self._woken.set()  # the first value is read by a request: an edge before this moment is no event
            try:
                async for message in socket:
                    self._take(message if isinstance(message, str) else message.decode("utf-8", "replace"))
            finally:
                self.live = False
                self._woken.set()

    def _subscribe(self) -> str:
        resource = f"/rw/iosystem/signals/{self._path};state"
        response = self._http.request(
            "POST",
            "/subscription",
            content=self._dialect.subscription_body(resource),
            headers={"Content-Type": self._dialect.form_type},
        )
        location = response.headers.get("Location", "")
        poll = re.search(r"/poll/(\w+)$", location)
        if response.status_code != 201 or poll is None:
            raise SubscriptionError(
                f"the controller does not let {resource} be subscribed to (status {response.status_code}); "
                "RobotWare 6.08 or newer is needed"
            )
        self._group = poll.group(1)
        # Of the answer only the path counts: behind a router the controller does not know its address.
        base = urlsplit(self._http.url)
        scheme = "wss" if base.scheme == "https" else "ws"
        return f"{scheme}://{base.netloc}/poll/{self._group}"

    def _unsubscribe(self) -> None:
        group, self._group = self._group, ""
        if group:
            with contextlib.suppress(LinkError):
                self._http.request("DELETE", f"/subscription/{group}", headers=self._dialect.change_headers)

    def _take(self, message: str) -> None:
        for path, level in _EVENT.findall(message):
            if path.rsplit("/", 1)[-1] == self._path.rsplit("/", 1)[-1]:
                self._edges.append(level == "1")
                self._woken.set()
