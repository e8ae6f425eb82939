"""Run the simulated web services on loopback, in a thread."""

from __future__ import annotations

import asyncio
import socket
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

import uvicorn

from doormill_ros.simulation.controller.rws_server.app import Behaviour, WebServices
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.certificate import write_certificate

_START_LIMIT = 20.0


class RwsServer:
    """A simulated controller's web services; a context manager that runs them in a thread."""

    def __init__(
        self,
        cabinet: Cabinet,
        version: int = 1,
        port: int = 0,
        behaviour: Behaviour | None = None,
        ping_interval: float = 30.0,
        certificates: Path | None = None,
        robotware: int = 0,
        clock_ahead: float = 0.0,
    ) -> None:
        """Bind the port; nothing is answered before `start`.

        Args:
            cabinet: HOME folder, signals and data it gives access to.
            version: 1 (http, digest) or 2 (https, basic).
            port: TCP port on 127.0.0.1, 0 for any free one.
            behaviour: Limits and account.
            ping_interval: Time between pings on event streams [s].
            certificates: Folder that version 2 writes controller.crt and controller.key to; None for a
                temporary one.
            robotware: Major version of RobotWare; 0 for the one that goes with `version`.
            clock_ahead: By how much the controller's clock is ahead, by which its certificate is dated [s].
        """
        self.version = version
        self.certificate: Path | None = None
        key: Path | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        if version == 2:
            if certificates is None:
                self._folder = tempfile.TemporaryDirectory(prefix="simulated-controller-")
                certificates = Path(self._folder.name)
            self.certificate, key = write_certificate(certificates, clock_ahead)
        self._socket = _listener(port)
        self.port = self._socket.getsockname()[1]
        self.url = f"{'http' if version == 1 else 'https'}://127.0.0.1:{self.port}"
        self.cabinet = cabinet
        self.services = WebServices(cabinet, version, f"{self.url}/", behaviour or Behaviour(), robotware)
        config = uvicorn.Config(
            self.services,
            log_level="critical",
            lifespan="off",
            ws="websockets-sansio",
            ws_ping_interval=ping_interval,
            timeout_keep_alive=60,
            timeout_graceful_shutdown=1,
            server_header=False,
            ssl_certfile=self.certificate,
            ssl_keyfile=key,
        )
        self._server = uvicorn.Server(config)
        self._runner = asyncio.Runner(loop_factory=asyncio.new_event_loop)
        self._loop = self._runner.get_loop()
        self._thread = threading.Thread(target=self._run, name="rws-server", daemon=True)
        self._listening = threading.Event()

    def start(self) -> RwsServer:
        """Answer requests from a thread; returns when the port listens."""
        self._thread.start()
        if not self._listening.wait(_START_LIMIT):
            raise RuntimeError(f"simulated controller on port {self.port} did not start")
        return self

    def stop(self) -> None:
        """End all connections and the thread."""
        self._server.should_exit = True
        self._server.force_exit = True
        if self._thread.is_alive():
            self._thread.join(_START_LIMIT)
        else:
            self._runner.close()
        self._socket.close()
        if self._folder is not None:
            self._folder.cleanup()

    def drop_streams(self) -> None:
        """Break every event stream."""
        self._in_loop(self.services.subscriptions.drop_streams)

    def expire_sessions(self) -> None:
        """End every session and challenge, as after a restart of the web server."""

        def expire() -> None:
            self.services.sessions.end_all()
            self.services.digest.forget()

        self._in_loop(expire)

    def __enter__(self) -> RwsServer:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _in_loop(self, action: Callable[[], None]) -> None:
        done = threading.Event()

        def run() -> None:
            action()
            done.set()

        self._loop.call_soon_threadsafe(run)
        done.wait(_START_LIMIT)

    def _run(self) -> None:
        with self._runner:
            self._runner.run(self._serve())

    async def _serve(self) -> None:
        watch = asyncio.ensure_future(self.services.subscriptions.watch())
        listening = asyncio.ensure_future(self._announce())
        try:
            await self._server.serve(sockets=[self._socket])
        finally:
            watch.cancel()
            listening.cancel()

    async def _announce(self) -> None:
        while not self._server.started:
            await asyncio.sleep(0.002)
        self._listening.set()


def _listener(port: int) -> socket.socket:
    """A socket bound to a port of 127.0.0.1."""
    # With the protocol named, asyncio turns Nagle's algorithm off; else each answer waits 40 ms.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
    except OSError:
        listener.close()
        raise
    return listener
