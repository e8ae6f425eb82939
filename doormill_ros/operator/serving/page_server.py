"""Serves the operator's page from a thread."""

from __future__ import annotations

import asyncio
import socket
import threading
from typing import Any

import uvicorn
from fastapi import FastAPI

from doormill_ros.cell.run.waiting import wait
from doormill_ros.operator.errors import PageAddressError
from doormill_ros.operator.serving.prompt_protocol import PromptProtocol

START_LIMIT = 20.0  # s
BACKLOG = 64  # connections
QUIET = 60.0  # s between two words on the same trouble


class PageServer:
    """A web application on a port of its own.

    Args:
        app: What is served.
        host: Address to listen at.
        port: TCP port, 0 for any free one.

    Raises:
        PageAddressError: The address is taken, not one of this machine, or none.
    """

    def __init__(self, app: FastAPI, host: str, port: int) -> None:
        if not host:  # a socket would take that for every network
            raise PageAddressError(
                "the operator's page has no host to be served at; name an address of this machine, 127.0.0.1 for "
                "itself alone or 0.0.0.0 for every network",
                host=host,
                port=port,
            )
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise PageAddressError(
                f"the operator's page cannot be served at {host} port {port}: {error.strerror or error}; "
                "choose another port or host",
                host=host,
                port=port,
            ) from error
        self.port = self._socket.getsockname()[1]
        self.url = f"http://{f'[{host}]' if ':' in host else host}:{self.port}/"
        # Requests are not logged: the log is no place for who asked what.
        self._server = uvicorn.Server(
            uvicorn.Config(
                app,
                http=PromptProtocol,
                # So many are taken at once, before any of them can be left.
                backlog=BACKLOG,
                log_level="critical",
                access_log=False,
                lifespan="off",
                timeout_graceful_shutdown=1,
                server_header=False,
                # Nothing of the page upgrades, and what a client says of its own address is not believed.
                ws="none",
                proxy_headers=False,
            )
        )
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve()),
            name="operator_page",
            daemon=True,
        )

    async def _serve(self) -> None:
        told: dict[str, float] = {}

        def tell(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
            # Where no file is left the loop tells of each of the connections that it cannot take.
            if loop.time() - told.get(context["message"], -QUIET) >= QUIET:
                told[context["message"]] = loop.time()
                loop.default_exception_handler(context)

        asyncio.get_running_loop().set_exception_handler(tell)
        await self._server.serve(sockets=[self._socket])

    def start(self) -> PageServer:
        """Answer requests from a thread; returns once it does.

        Raises:
            PageAddressError: It does not within 20 s.
        """
        self._thread.start()
        tried = threading.Condition()
        wait(tried, lambda: self._server.started or not self._thread.is_alive(), START_LIMIT)
        if not self._server.started:
            raise PageAddressError(f"the operator's page at {self.url} did not start; restart it")
        return self

    def stop(self) -> None:
        """End all connections, live ones too, and the thread."""
        self._server.should_exit = True
        self._server.force_exit = True
        if self._thread.is_alive():
            self._thread.join(START_LIMIT)
        self._socket.close()

    def __enter__(self) -> PageServer:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()
