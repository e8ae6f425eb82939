"""A TCP relay in front of the simulated web services that drops, slows and holds back what passes."""

from __future__ import annotations

import contextlib
import random
import socket
import threading
import time

from support.faults.scenario import Scenario


class Relay:
    """Relays connections to a port; misbehaves while `active`."""

    def __init__(self, port: int, scenario: Scenario) -> None:
        self._target = port
        self._kind = scenario.kind
        self._options = scenario.options
        self._meddles = scenario.kind.startswith(("dropped", "slow", "delivery"))
        self._chance = random.Random(f"relay/{scenario.seed}")
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self.active = True
        self.hits = 0
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        """Stop accepting."""
        self._socket.close()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._socket.accept()
            except OSError:
                return
            try:
                server = socket.create_connection(("127.0.0.1", self._target), timeout=5)
                server.settimeout(None)
            except OSError:
                client.close()
                continue
            for end in (client, server):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self._to_server, args=(client, server), daemon=True).start()
            threading.Thread(target=self._pump, args=(server, client, False), daemon=True).start()

    def _to_server(self, client: socket.socket, server: socket.socket) -> None:
        self._pump(client, server, True)

    def _pump(self, source: socket.socket, sink: socket.socket, outward: bool) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                if self.active and not self._meddle(source, sink, data, outward):
                    break
                sink.sendall(data)
        for end in (sink, source):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            with contextlib.suppress(OSError):
                end.close()

    def _meddle(self, source: socket.socket, sink: socket.socket, data: bytes, outward: bool) -> bool:
        """False ends the connection."""
        if not self._meddles or self._chance.random() >= self._options["probability"]:
            return True
        self.hits += 1
        if self._kind == "dropped connections":
            if self._chance.random() < 0.5:
                with contextlib.suppress(OSError):
                    sink.sendall(data[: self._chance.randrange(len(data) + 1)])
            return False
        if self._kind == "slow connection":
            time.sleep(self._chance.uniform(0.05, 0.4))
        elif self._kind.startswith("delivery") and outward:
            time.sleep(
                self._options["hold"]
            )  # the client has given up and closed; it is delivered all the same
        return True
