"""Under which names the page is reached, so that a foreign name that is pointed at this machine reads nothing of it."""

from __future__ import annotations

import ipaddress
import re
import socket
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from doormill_ros.operator.errors import PageAddressError

_NAME = re.compile(r"[A-Za-z0-9]([A-Za-z0-9-]*[A-Za-z0-9])?(\.[A-Za-z0-9]([A-Za-z0-9-]*[A-Za-z0-9])?)*")
_SHOWN = 100  # characters


def page_names(text: str) -> tuple[str, ...]:
    """Host names of a list with commas.

    Raises:
        PageAddressError: One of them is no host name.
    """
    names = tuple(name.strip().lower() for name in text.split(",") if name.strip())
    for name in names:
        if not _NAME.fullmatch(name):
            raise PageAddressError(
                f"the page is to be reached as {name!r}, allowed are host names without scheme and port, several with "
                "commas; correct the parameter names of /operator_page"
            )
    return names


def host_name(host: str) -> str:
    """The name or address in a Host header, without its port; empty where there is none."""
    try:
        asked = urlsplit(f"//{host}")
        return "" if asked.netloc != host or "@" in host else asked.hostname or ""
    except ValueError:  # an address with half its brackets
        return ""


def is_address(name: str) -> bool:
    """Whether a name is an IP address: nobody can point one elsewhere."""
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class KnownHost:
    """Answers 400 to every request for another name than the page's own.

    A page of another site whose name is pointed at this machine has that name in its requests (DNS rebinding).

    Args:
        app: What answers.
        names: Of the page, beside localhost, this machine's own and every IP address; lower case.
    """

    def __init__(self, app: ASGIApp, names: tuple[str, ...]) -> None:
        self._app = app
        self._names = {"localhost", socket.gethostname().lower(), *names}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        hosts = Headers(scope=scope).getlist("host")
        asked = [host_name(host) for host in hosts]
        if len(asked) == 1 and (asked[0] in self._names or is_address(asked[0])):
            await self._app(scope, receive, send)
            return
        found = hosts[0][:_SHOWN] if hosts else ""
        sentence = (
            f"the page was asked for as {found!r}, which is none of its names; open it by its address, or add the "
            "name to the parameter names of /operator_page"
        )
        await JSONResponse({"detail": sentence}, 400)(scope, receive, send)
