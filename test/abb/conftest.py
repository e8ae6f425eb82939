"""Simulated web services of both versions and a link to them; fixtures that stand in `support` for several folders."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.rapid_bench import door  # noqa: F401
from support.web_services import link_to


@pytest.fixture(params=[1, 2])
def server(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[RwsServer]:
    with RwsServer(Cabinet.create(tmp_path), request.param) as running:
        yield running


@pytest.fixture
def link(server: RwsServer) -> Iterator[RwsTransport]:
    transport = link_to(server)
    yield transport
    transport.close()
