"""A running page and what drives it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from doormill_ros.cell.errors import CellBusyError, NodeInactiveError
from doormill_ros.models.errors import UnknownVersionError
from doormill_ros.operator.access.token import Keys, new_token
from doormill_ros.operator.orders.audit import AuditLog
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from support.browser import TABLET, open_page
from support.waiting import LIMIT

NASTY = "<script>document.title='broken'</script>"


@dataclass
class ControlSpy:
    """Notes what the page asked for; refuses the door called `busy`."""

    orders: list[str] = field(default_factory=list)

    def mill(self, door_id: str) -> str:
        if door_id == "busy":
            raise CellBusyError("another door is being milled")
        if door_id.startswith("silent"):
            raise NodeInactiveError(f"door {door_id} was not started")
        if door_id == "bug":
            raise RuntimeError("nobody foresaw this")
        self.orders.append(f"mill {door_id}")
        return f"door {door_id} is started"

    def cancel(self) -> str:
        self.orders.append("cancel")
        return "canceled"

    def accept(self, version: int, who: str, why: str) -> str:
        if version == 99:
            raise UnknownVersionError("version 99 of the model was never proposed")
        self.orders.append(f"accept {version}, {who}: {why}")
        return f"version {version} is in use"

    def revert(self, version: int, who: str, why: str) -> str:
        self.orders.append(f"revert {version}, {who}: {why}")
        return "version 0 is in use"

    def doors(self, prefix: str) -> list[str]:
        if prefix == "silent":
            raise NodeInactiveError("the recipe database does not answer")
        return [door for door in ("oak", "oak_2", NASTY) if door.startswith(prefix)]


@dataclass
class Served:
    """A page on a port of its own."""

    url: str
    store: ViewStore
    control: ControlSpy | None
    token: str


@pytest.fixture(params=[False, True], ids=["read-only", "with-control"])
def either(request: pytest.FixtureRequest) -> Iterator[Served]:
    yield from _serve(request.param)


@pytest.fixture
def read_only() -> Iterator[Served]:
    yield from _serve(False)


@pytest.fixture
def controlled() -> Iterator[Served]:
    yield from _serve(True)


def _serve(with_control: bool) -> Iterator[Served]:
    store, token = ViewStore(), new_token()
    control = ControlSpy() if with_control else None
    app = create_app(store, control, token if with_control else None)
    with PageServer(app, "127.0.0.1", 0) as server:
        yield Served(server.url, store, control, token)


@dataclass
class Guarded:
    """A page with both tokens, an audit log, and a clock that the test sets."""

    url: str
    control: ControlSpy
    store: ViewStore
    keys: Keys
    folder: Path
    now: list[float]

    def order(
        self, token: str | None, path: str = "control/cancel", method: str = "POST", **kwargs: object
    ) -> httpx.Response:
        """Send an order; `headers` are sent beside the token."""
        headers = {"Authorization": f"Bearer {token}"} if token is not None else {}
        headers |= kwargs.pop("headers", {})
        return httpx.request(method, self.url + path, headers=headers, timeout=LIMIT, **kwargs)


@pytest.fixture
def guarded(tmp_path: Path) -> Iterator[Guarded]:
    store, control, keys = ViewStore(), ControlSpy(), Keys(new_token(), new_token())
    folder, now = tmp_path / "audit", [0.0]
    app = create_app(store, control, keys, audit=AuditLog(folder), clock=lambda: now[0])
    with PageServer(app, "127.0.0.1", 0) as server:
        yield Guarded(server.url, control, store, keys, folder, now)


@pytest.fixture
def shown(read_only: Any) -> Iterator[tuple[Any, Page, list[str]]]:
    with open_page(read_only.url, **TABLET) as (page, errors):
        expect(page.locator("#lost")).to_be_hidden()
        yield read_only, page, errors
