"""Connections to the operator's page: few, and only of who asks in good time."""

from __future__ import annotations

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

PATIENCE = 10.0  #: s for the head and the body of a request
CONNECTIONS = 400  #: at a time, those of browsers that show the page among them


class PromptProtocol(H11Protocol):
    """Leaves whoever begins a request and does not end it; where there are too many, the one that waited longest."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._patience: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """See the base class."""
        super().connection_made(transport)
        self._expect()
        if len(self.connections) > CONNECTIONS:
            waiting = [
                (one._patience.when(), number, one)
                for number, one in enumerate(self.connections)
                if isinstance(one, PromptProtocol) and one._patience is not None
            ]
            if waiting:
                min(waiting)[-1]._leave()

    def data_received(self, data: bytes) -> None:
        """See the base class."""
        super().data_received(data)
        self._expect()

    def connection_lost(self, exc: Exception | None) -> None:
        """See the base class."""
        self._forget()
        super().connection_lost(exc)

    def _expect(self) -> None:
        """The time of a request runs from its first letter on, and while its end is missing."""
        if self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            self._forget()
        elif self._patience is None:
            self._patience = self.loop.call_later(PATIENCE, self._leave)

    def _forget(self) -> None:
        if self._patience is not None:
            self._patience.cancel()
            self._patience = None

    def _leave(self) -> None:
        self._forget()
        self.connections.discard(self)
        self.transport.abort()
