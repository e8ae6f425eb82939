"""Transports by name: adding one is a new file beside this one and a line in TRANSPORTS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from doormill_ros.abb.credentials import load_credentials
from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport

if TYPE_CHECKING:
    from doormill_ros.abb.transports.rws_http import LinkTimeouts


SIMULATED_TRANSPORT = "simulated_folder"  #: the way to a controller that moves no robot
#: Longest wait for one answer of a controller [s], unless somebody knows that it is slower.
ANSWER = 4.0


@dataclass(frozen=True)
class TransportOptions:
    """What a transport may need; none of it is secret.

    Attributes:
        address: HOME of a simulated controller, URL of Robot Web Services.
        certificate: PEM file with the controller's certificate, for https.
        insecure: Trust any certificate instead.
        answer: Longest wait for one answer [s].
    """

    address: str
    certificate: Path | None = None
    insecure: bool = False
    answer: float = ANSWER


def _rws1(options: TransportOptions) -> Transport:
    from doormill_ros.abb.transports.rws import (
        connect_rws1,  # late: its libraries take a fifth of the bridge's start
    )

    return connect_rws1(options.address, load_credentials(), timeouts=_timeouts(options))


def _rws2(options: TransportOptions) -> Transport:
    from doormill_ros.abb.transports.rws import connect_rws2  # late, as above

    return connect_rws2(
        options.address,
        load_credentials(),
        certificate=options.certificate,
        insecure=options.insecure,
        timeouts=_timeouts(options),
    )


def _timeouts(options: TransportOptions) -> LinkTimeouts:
    from doormill_ros.abb.transports.rws_http import LinkTimeouts  # late, as above

    return LinkTimeouts.within(options.answer)


TRANSPORTS: dict[str, Callable[[TransportOptions], Transport]] = {
    SIMULATED_TRANSPORT: lambda o: SimulatedFolderTransport(o.address, o.answer),
    "rws1": _rws1,
    "rws2": _rws2,
}


#: Names that transports had before, and what they are called now.
_FORMER = {"shared_folder": "simulated_folder"}


def open_transport(name: str, options: TransportOptions) -> Transport:
    """Open the way to a controller.

    Raises:
        UnknownTransportError: No transport of that name.
        LinkError: It cannot be opened.
    """
    if name in _FORMER:
        raise UnknownTransportError(
            f"transport is {name!r}, which is named {_FORMER[name]!r} now, because no real controller shows its "
            "signals as files: write that name, or rws1 or rws2 for a real controller",
            name=name,
        )
    if name not in TRANSPORTS:
        raise UnknownTransportError(
            f"transport is {name!r}, allowed are {', '.join(TRANSPORTS)}; correct the bridge's parameter",
            name=name,
        )
    return TRANSPORTS[name](options)
