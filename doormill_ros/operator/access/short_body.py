"""Refuses orders with a long body before it is in memory."""

from __future__ import annotations

from fastapi.responses import JSONResponse
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from doormill_ros.operator.access.order_paths import is_order

LARGEST_BODY = 10_000  # bytes; an order's longest texts with every letter escaped take less


class ShortBody:
    """Answers 413 to an order with more than `LARGEST_BODY`, whether it says so first or just sends it."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on with its whole body, or refuse it."""
        if not is_order(scope):
            await self._app(scope, receive, send)
            return
        told = Headers(scope=scope).get("content-length", "")
        came: list[Message] = []
        size, more = 0, True
        fits = not told.isdecimal() or float(told) <= LARGEST_BODY
        while fits and more:
            came.append(await receive())
            size += len(came[-1].get("body", b""))
            fits, more = size <= LARGEST_BODY, came[-1].get("more_body", False)
        if not fits:
            sentence = f"the order has more than {LARGEST_BODY} bytes, no order is as long; send one as the page does"
            await JSONResponse({"detail": sentence}, 413)(scope, receive, send)
            return

        async def again() -> Message:
            return came.pop(0) if came else await receive()

        await self._app(scope, again, send)
