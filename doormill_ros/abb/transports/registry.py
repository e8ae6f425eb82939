"""Transports by name: adding one is a new file beside this one and a line in TRANSPORTS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.abb.credentials import load_credentials
from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transports.rws import connect_rws1, connect_rws2
from doormill_ros.abb.transports.shared_folder import SharedFolderTransport


@dataclass(frozen=True)
class TransportOptions:
    """What a transport may need; none of it is secret.

    Attributes:
        address: Folder of a shared folder, URL of Robot Web Services.
        certificate: PEM file with the controller's certificate, for https.
        insecure: Trust any certificate instead.
    """

    address: str
    certificate: Path | None = None
    insecure: bool = False


TRANSPORTS: dict[str, Callable[[TransportOptions], Transport]] = {
    "shared_folder": lambda o: SharedFolderTransport(o.address),
    "rws1": lambda o: connect_rws1(o.address, load_credentials()),
    "rws2": lambda o: connect_rws2(
        o.address, load_credentials(), certificate=o.certificate, insecure=o.insecure
    ),
}


def open_transport(name: str, options: TransportOptions) -> Transport:
    """Open the way to a controller.

    Raises:
        UnknownTransportError: No transport of that name.
        LinkError: It cannot be opened.
    """
    if name not in TRANSPORTS:
        raise UnknownTransportError(
            f"transport is {name!r}, allowed are {', '.join(TRANSPORTS)}; correct the bridge's parameter",
            name=name,
        )
    return TRANSPORTS[name](options)
