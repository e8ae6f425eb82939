"""The operator's page as a web application: files, live events, and control for who has the token."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from fastapi import FastAPI, HTTPException, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, StreamingResponse
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from doormill_ros.operator.access.doorkeeper import Doorkeeper
from doormill_ros.operator.access.origin import OwnOrigin
from doormill_ros.operator.access.short_body import ShortBody
from doormill_ros.operator.access.token import Keys
from doormill_ros.operator.access.tries import Tries
from doormill_ros.operator.errors import AuditError
from doormill_ros.operator.history.history_pages import serve_history
from doormill_ros.operator.languages import LANGUAGES
from doormill_ros.operator.orders.audit import AuditLog
from doormill_ros.operator.orders.audited import Audited
from doormill_ros.operator.orders.order_texts import no_order
from doormill_ros.operator.orders.orders import ROLES, Control, serve_orders
from doormill_ros.operator.serving.event_streams import EventStreams
from doormill_ros.operator.serving.page_names import KnownHost
from doormill_ros.operator.views.state import CellView
from doormill_ros.operator.views.view_store import ViewStore

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
_FILES = {
    "/": ("page.html", "text/html"),
    "/page.css": ("page.css", "text/css"),
    "/page.js": ("page.js", "text/javascript"),
    "/language.js": ("language.js", "text/javascript"),
    "/door.js": ("door.js", "text/javascript"),
    "/history.js": ("history.js", "text/javascript"),
    "/model.js": ("model.js", "text/javascript"),
    "/monitor_words.js": ("monitor_words.js", "text/javascript"),
    "/runs.js": ("runs.js", "text/javascript"),
    "/runs_words.js": ("runs_words.js", "text/javascript"),
    **{
        f"/texts/{name}.json": (f"texts/{name}.json", "application/json")
        for code in LANGUAGES
        for name in (code, f"errors/{code}")
    },
    "/reports.js": ("reports.js", "text/javascript"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}
READ = ["GET", "HEAD"]


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


def create_app(
    store: ViewStore,
    control: Control | None = None,
    token: str | Keys | None = None,
    names: tuple[str, ...] = (),
    audit: AuditLog | None = None,
    clock: Callable[[], float] = time.monotonic,
    history: Path | None = None,
) -> FastAPI:
    """The application.

    Args:
        store: What is shown.
        control: What may be done; None for a page that only shows.
        token: Needed for control: that of the role operate, or the tokens of all roles.
        names: Under which the page may be asked for, beside localhost, this machine's name and IP addresses.
        audit: Where orders and refused tries are written down; None: nowhere.
        clock: Monotonic time that limits the tries of tokens [s].
        history: Folder of the ended runs; None: those in the view are all that can be searched.

    Raises:
        ValueError: Control without a token.
    """
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    if control is not None:
        keys = token if isinstance(token, Keys) else Keys(token)
        if not keys:
            raise ValueError("control of the cell needs a token; pass one made by new_token()")
        serve_orders(app, control, audit)
        app.add_middleware(ShortBody)
        app.add_middleware(Doorkeeper, keys=keys, tries=Tries(clock), roles=ROLES)
    # The last one added sees a request first.
    app.add_middleware(OwnOrigin, names=names)
    app.add_middleware(KnownHost, names=names)
    if audit is not None:
        app.add_middleware(Audited, audit=audit, complain=lambda text: store.update(_unwritten(text)))
    app.add_middleware(_Headers)
    app.add_exception_handler(Exception, _unforeseen)
    app.add_exception_handler(RequestValidationError, no_order)
    for path, (name, media_type) in _FILES.items():
        _serve_file(app, path, name, media_type)
    _serve_view(app, store, control is not None)
    serve_history(app, store, history)
    return app


def _unwritten(sentence: str) -> Callable[[CellView], CellView]:
    return lambda view: view.with_fault("the audit log", sentence, AuditError.code)


async def _unforeseen(request: Request, error: Exception) -> Response:
    # Made outside of every layer that adds headers.
    return JSONResponse(
        {"detail": f"the page failed by {type(error).__name__}; restart the cell if it does so again"},
        500,
        HEADERS,
    )


def _serve_file(app: FastAPI, path: str, name: str, media_type: str) -> None:
    content = (files("doormill_ros.operator") / "browser" / name).read_bytes()

    # HEAD too: what watches over pages asks so whether they are there.
    @app.api_route(path, methods=READ)
    async def file() -> Response:
        return Response(content, media_type=media_type)


def _serve_view(app: FastAPI, store: ViewStore, control: bool) -> None:
    def document() -> str:
        return json.dumps({**store.view.document(), "control": control})

    @app.api_route("/state", methods=READ)
    async def state() -> Response:
        return Response(document(), media_type="application/json")

    streams = EventStreams(store, document)

    @app.get("/events")
    async def events() -> StreamingResponse:
        return streams.open()

    @app.get("/picture/{number}")
    async def picture(number: int) -> Response:
        shown = store.view.picture
        if shown is None or shown.number != number:
            raise HTTPException(404, "this picture is no longer there; the page shows the newest")
        return Response(shown.data, media_type=shown.media_type)
