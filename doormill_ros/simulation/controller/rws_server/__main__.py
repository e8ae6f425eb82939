"""Serve a HOME folder: `python -m doormill_ros.simulation.controller.rws_server --home DIR --port 8080`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer


def main() -> None:
    """Parse the command line and serve until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--home", type=Path, required=True, help="the controller's HOME folder")
    parser.add_argument("--port", type=int, default=0, help="TCP port on 127.0.0.1, 0 for any")
    parser.add_argument("--version", type=int, choices=(1, 2), default=1, help="of the web services")
    arguments = parser.parse_args()
    server = RwsServer(Cabinet.create(arguments.home), arguments.version, arguments.port)
    sys.stdout.write(f"{server.url}\n")
    sys.stdout.flush()
    server.serve()


if __name__ == "__main__":
    main()
