"""Refuses requests that another site's page makes with the operator's browser."""

from __future__ import annotations

from collections.abc import Collection
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send

_PORTS = {"http": 80, "https": 443}
_SHOWN = 100  # characters


def is_own(origin: str, host: str) -> bool:
    """Whether an Origin header names the place that the Host header of the same request names.

    The scheme is free, so that the page may stand behind a server that encrypts. "null" is no place.
    """
    try:
        asked, here = urlsplit(origin), urlsplit(f"//{host}")
        port = _PORTS.get(asked.scheme)
        if (
            port is None
            or not asked.hostname
            or f"{asked.scheme}://{asked.netloc}" != origin
            or "@" in asked.netloc
        ):
            return False
        return (asked.hostname, asked.port or port) == (here.hostname, here.port or port)
    except ValueError:  # a port that is no number, an address with half its brackets
        return False


def is_named(origin: str, names: Collection[str]) -> bool:
    """Whether an Origin header names one of the hosts, at whatever port."""
    return any(is_own(origin, f"{name}:{_port(origin)}") for name in names)


def _port(origin: str) -> int | None:
    try:
        asked = urlsplit(origin)
        return asked.port or _PORTS.get(asked.scheme)
    except ValueError:
        return None


class OwnOrigin:
    """Answers 403 to every request with a foreign Origin.

    Programs that are no browsers send none and pass; orders need the token all the same.

    Args:
        app: What answers.
        names: Under which the page is reached through a server that asks for it by another one; lower case.
    """

    def __init__(self, app: ASGIApp, names: tuple[str, ...] = ()) -> None:
        self._app = app
        self._names = names

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on or refuse it."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        foreign = [
            origin
            for origin in headers.getlist("origin")
            if not (is_own(origin, host) or is_named(origin, self._names))
        ]
        if not foreign:
            await self._app(scope, receive, send)
            return
        sentence = (
            f"the request was made by a page of {foreign[0][:_SHOWN]!r}, allowed are requests of this cell's own page; "
            "open that page and order there"
        )
        await JSONResponse({"detail": sentence}, 403)(scope, receive, send)
