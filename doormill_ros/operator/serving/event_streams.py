"""The live view for browsers: a stream of server-sent events for each, and no more of them than a cell has use for."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import suppress

from fastapi import HTTPException
from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from doormill_ros.operator.views.view_store import ViewStore

KEEP_ALIVE = 5.0  # s, the longest silence on a stream
MOST_STREAMS = 100


class EventStreams:
    """Counts the streams; used from the server's event loop alone.

    Args:
        store: Tells of changes.
        document: What is sent after each.
        most: So many at once.
    """

    def __init__(self, store: ViewStore, document: Callable[[], str], most: int = MOST_STREAMS) -> None:
        self._store = store
        self._document = document
        self._left = most
        self._most = most

    def open(self) -> StreamingResponse:
        """One more stream, until its client goes.

        Raises:
            HTTPException: 503, there are too many.
        """
        if self._left < 1:
            raise HTTPException(
                503, f"{self._most} browsers show the page already; close it where nobody looks at it"
            )
        self._left -= 1
        return _Stream(_events(self._store, self._document), self._close)

    def _close(self) -> None:
        self._left += 1


class _Stream(StreamingResponse):
    """Says when it is over, whether it came to a first event or not."""

    def __init__(self, content: AsyncIterator[str], over: Callable[[], None]) -> None:
        super().__init__(content, media_type="text/event-stream")
        self._over = over

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._over()


async def _events(store: ViewStore, document: Callable[[], str]) -> AsyncIterator[str]:
    """The view at once, after every change, and a sign of life in between."""
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def notify() -> None:
        # The page may be closing while the cell still changes.
        with suppress(RuntimeError):
            loop.call_soon_threadsafe(changed.set)

    end = store.listen(notify)
    try:
        while True:
            changed.clear()
            yield f"data: {document()}\n\n"
            while True:
                try:
                    await asyncio.wait_for(changed.wait(), KEEP_ALIVE)
                    break
                except TimeoutError:
                    yield "event: alive\ndata: -\n\n"
    finally:
        end()
