"""Links to simulated web services of either version, more patient than those of the cell."""

from __future__ import annotations

from typing import Any

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.transports.rws import RwsTransport, connect_rws1, connect_rws2
from doormill_ros.abb.transports.rws_http import LinkTimeouts
from doormill_ros.simulation.controller.rws_server.server import RwsServer

LOGIN = Credentials("Default User", "robotics")
#: A loaded machine must not turn an answer into a timeout.
PATIENT = LinkTimeouts.within(120.0)


def link_to(
    server: RwsServer, credentials: Credentials = LOGIN, subscribe: bool = False, **options: Any
) -> RwsTransport:
    """A link that whoever opens it closes; without events unless told otherwise."""
    options = {"timeouts": PATIENT, "subscribe": subscribe, **options}
    if server.version == 1:
        return connect_rws1(server.url, credentials, **options)
    return connect_rws2(server.url, credentials, certificate=server.certificate, **options)
