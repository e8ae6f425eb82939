"""The operator's page as a web application: files, live events, and control for who has the token."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from importlib.resources import files
from typing import Annotated, Protocol, TypeVar

from fastapi import Depends, FastAPI, HTTPException, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, Field
from starlette.datastructures import MutableHeaders
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from doormill_ros.errors import DoormillError
from doormill_ros.operator.state import ViewStore
from doormill_ros.operator.token import authorizes

Value = TypeVar("Value")

LONGEST_ID = 100  # characters
KEEP_ALIVE = 5.0  # s, the longest silence on the event stream
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
_FILES = {
    "/": ("page.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}


class _Headers:
    """Adds `HEADERS` to every answer, streams included."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        await self._app(scope, receive, send_with_headers)


class Control(Protocol):
    """What the page may do to the cell; each answers with a sentence for the operator."""

    def mill(self, door_id: str) -> str:
        """Start milling a door.

        Raises:
            DoormillError: It cannot be started.
        """

    def cancel(self) -> str:
        """End the run in hand.

        Raises:
            DoormillError: There is nobody to end it.
        """

    def doors(self, prefix: str) -> list[str]:
        """Some of the doors whose id starts so.

        Raises:
            DoormillError: The recipe database does not answer.
        """


class MillRequest(BaseModel):
    """Body of a request to mill a door."""

    door_id: str = Field(min_length=1, max_length=LONGEST_ID)


def create_app(
    store: ViewStore,
    control: Control | None = None,
    token: str | None = None,
    hosts: tuple[str, ...] = ("127.0.0.1", "localhost"),
) -> FastAPI:
    """The application.

    Args:
        store: What is shown.
        control: What may be done; None for a page that only shows.
        token: Needed for control.
        hosts: Names under which the page may be asked for, so that no foreign name pointed at this machine
            reads it; "*" for any.

    Raises:
        ValueError: Control without a token.
    """
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=list(hosts))

    app.add_middleware(_Headers)
    for path, (name, media_type) in _FILES.items():
        _serve_file(app, path, name, media_type)
    _serve_view(app, store, control is not None)
    if control is not None:
        if not token:
            raise ValueError("control of the cell needs a token; pass one made by new_token()")
        _serve_control(app, control, token)
    return app


def _serve_file(app: FastAPI, path: str, name: str, media_type: str) -> None:
    content = (files("doormill_ros.operator") / name).read_bytes()

    @app.get(path)
    async def file() -> Response:
        return Response(content, media_type=media_type)


def _serve_view(app: FastAPI, store: ViewStore, control: bool) -> None:
    def document() -> str:
        return json.dumps({**store.view.document(), "control": control})

    @app.get("/state")
    async def state() -> Response:
        return Response(document(), media_type="application/json")

    @app.get("/events")
    async def events() -> StreamingResponse:
        return StreamingResponse(_events(store, document), media_type="text/event-stream")

    @app.get("/picture/{number}")
    async def picture(number: int) -> Response:
        shown = store.view.picture
        if shown is None or shown.number != number:
            raise HTTPException(404, "this picture is no longer there; the page shows the newest")
        return Response(shown.data, media_type=shown.media_type)


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


def _serve_control(app: FastAPI, control: Control, token: str) -> None:
    async def allowed(request: Request) -> None:
        if not authorizes(request.headers.get("authorization"), token):
            raise HTTPException(
                401,
                "the token is missing or wrong; it was printed when the cell was started",
                {"WWW-Authenticate": "Bearer"},
            )

    async def answer(action: Callable[..., Value], *arguments: str) -> Value:
        try:
            return await run_in_threadpool(action, *arguments)
        except DoormillError as error:
            raise HTTPException(409, error.message) from error

    # The token is looked at before the body is.
    @app.get("/control", dependencies=[Depends(allowed)])
    async def check() -> dict[str, str]:
        return {"message": "the token is right"}

    @app.post("/control/mill", dependencies=[Depends(allowed)], status_code=202)
    async def mill(wanted: MillRequest) -> dict[str, str]:
        return {"message": await answer(control.mill, wanted.door_id)}

    @app.post("/control/cancel", dependencies=[Depends(allowed)], status_code=202)
    async def cancel() -> dict[str, str]:
        return {"message": await answer(control.cancel)}

    # To be offered before the token is typed; the page shows door ids to everybody anyway.
    @app.get("/doors")
    async def doors(prefix: Annotated[str, Query(max_length=LONGEST_ID)] = "") -> list[str]:
        return await answer(control.doors, prefix)
