"""What docs/controller-link.md prints: limits of waits, and how often something is asked."""

from __future__ import annotations

import inspect

from doormill_ros.abb.handshake.state import HandshakeTimeouts
from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport

TIMEOUTS = HandshakeTimeouts()


def _default(call: type, name: str) -> float:
    return float(inspect.signature(call).parameters[name].default)


def looks_a_second() -> float:
    """How often the ready signal is read back while nothing happens."""
    return 1.0 / TIMEOUTS.watch


def polls_a_second() -> float:
    """How often the request is polled over the web services while no event stream is there."""
    return 1.0 / _default(RwsTransport, "poll_interval")


def folder_poll() -> float:
    """How often the request is polled in the simulated folder [s]."""
    return _default(SimulatedFolderTransport, "poll_interval")
