"""Which requests are orders."""

from __future__ import annotations

from starlette.types import Scope

ORDERS = "/control"


def is_order(scope: Scope) -> bool:
    """Whether a request is below `ORDERS`, whether anything answers there or not."""
    # Routes match with a line's end behind them, too.
    return scope["type"] == "http" and f"{scope['path'].rstrip()}/".startswith(f"{ORDERS}/")
