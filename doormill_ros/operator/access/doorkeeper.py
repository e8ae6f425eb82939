"""Who may give which order: looked at before anything of the order's body is."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fastapi.responses import JSONResponse
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from doormill_ros.operator.access.order_paths import is_order
from doormill_ros.operator.access.token import Keys, Role
from doormill_ros.operator.access.tries import Tries


class Doorkeeper:
    """Refuses orders with 401 of who has no token, 403 whose token is for less, 429 who guesses.

    Leaves the `holder` of the token in the request's state.

    Args:
        app: What answers the others.
        keys: The tokens.
        tries: Wrong tokens so far.
        roles: What the order of a path needs; one that is not named needs the highest role.
    """

    def __init__(self, app: ASGIApp, keys: Keys, tries: Tries, roles: Mapping[str, Role]) -> None:
        self._app = app
        self._keys = keys
        self._tries = tries
        self._roles = roles

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on or refuse it."""
        refusal = self._refusal(scope) if is_order(scope) else None
        await (refusal or self._app)(scope, receive, send)

    def _refusal(self, scope: Scope) -> JSONResponse | None:
        address = scope["client"][0] if scope.get("client") else ""
        wait = math.ceil(self._tries.wait(address))
        if wait > 0:
            return _refused(
                429,
                f"too many wrong tokens came from {address}; wait {wait} s, then try again with the right one",
                {"Retry-After": str(wait)},
            )
        header = Headers(scope=scope).get("authorization")
        found = self._keys.holder(header)
        if found is None:
            if header:  # without one nothing was guessed
                self._tries.failed(address)
            return _refused(
                401,
                "the token is missing or wrong; it was printed when the cell was started",
                {"WWW-Authenticate": "Bearer"},
            )
        scope.setdefault("state", {})["holder"] = found
        if found.role < self._roles.get(scope["path"], max(Role)):
            return _refused(
                403,
                f"this token allows to {found.role.word}, the order needs the token of the {max(Role).word}",
            )
        return None


def _refused(status: int, sentence: str, headers: Mapping[str, str] | None = None) -> JSONResponse:
    return JSONResponse({"detail": sentence}, status, headers)
