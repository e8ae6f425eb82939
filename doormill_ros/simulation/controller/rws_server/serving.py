"""Simulated web services by the name of the transport that reaches them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.errors import WebServicesError

if TYPE_CHECKING:
    from doormill_ros.simulation.controller.rws_server.server import RwsServer

#: Version by the name.
VERSIONS = {"rws1": 1, "rws2": 2}


def serve(name: str, cabinet: Cabinet, port: int, certificates: Path) -> RwsServer | None:
    """Web services by the name of the transport that reaches them; they answer until `RwsServer.stop`.

    Args:
        name: "rws1" or "rws2"; empty for none.
        cabinet: What they give access to.
        port: TCP port on 127.0.0.1, 0 for any free one.
        certificates: Folder that version 2 writes controller.crt and controller.key to.

    Raises:
        UnknownTransportError: Another name.
        WebServicesError: The port is taken, or the folder cannot be written.
    """
    if not name:
        return None
    if name not in VERSIONS:
        raise UnknownTransportError(
            f"web services are {name!r}, allowed are {', '.join(VERSIONS)}, or none when empty: correct the "
            "simulated controller's parameter",
            name=name,
        )
    # Late: its libraries take a tenth of the simulator's start, and without web services nobody needs them.
    from doormill_ros.simulation.controller.rws_server.server import RwsServer

    try:
        return RwsServer(cabinet, VERSIONS[name], port, certificates=certificates).start()
    except OSError as error:
        raise WebServicesError(
            f"the simulated controller cannot serve {name} on port {port}: {error}; allowed are a free port "
            f"and a folder {certificates} that can be written: choose others",
            port=port,
        ) from error
