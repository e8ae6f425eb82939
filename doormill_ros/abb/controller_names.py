"""Names of one controller on a network, the same however its address is written."""

from __future__ import annotations

import ipaddress
import posixpath
import socket
from pathlib import Path
from urllib.parse import urlsplit

_PORTS = {"http": 80, "https": 443}
_Address = ipaddress.IPv4Address | ipaddress.IPv6Address


def controller_names(address: str) -> tuple[str, ...]:
    """What a controller is called; two addresses lead to one controller where they have a name in common.

    Host names are resolved and this machine's own addresses are its name too; a port that is left out is the
    scheme's, and links of a file system are followed.

    Args:
        address: URL of Robot Web Services, or the folder that stands for a simulated controller.

    Returns:
        One name or more, without double ones; the first is the one to be shown.
    """
    if "://" not in address:
        return (f"{socket.gethostname()}:{Path(address).resolve()}",)
    parts = urlsplit(address)
    host = (parts.hostname or "").rstrip(".")
    path = posixpath.normpath(parts.path).strip("/.")
    try:
        port = parts.port or _PORTS.get(parts.scheme, 0)
    except ValueError:  # no number: the transport refuses it
        port = 0
    hosts = dict.fromkeys(name for found in _resolved(host) for name in _hosts(found))
    if socket.gethostname() not in hosts:  # what one PC calls localhost is not what another one does
        hosts = {host: None, **hosts}  # another bridge may not have been able to resolve it
    return tuple(f"{name}:{port}/{path}".rstrip("/") for name in hosts)


def _resolved(host: str) -> list[_Address]:
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return []
    # An address of this link alone ends in the name of this machine's interface.
    return [ipaddress.ip_address(str(one[4][0]).partition("%")[0]) for one in found]


def _hosts(address: _Address) -> list[str]:
    """An address, and this machine where it is one of its own."""
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    address = mapped or address
    if address.is_loopback or address.is_unspecified:  # to connect to the latter is to connect to oneself
        return [socket.gethostname()]
    return [str(address), socket.gethostname()] if _is_own(address) else [str(address)]


def _is_own(address: _Address) -> bool:
    family = socket.AF_INET6 if address.version == 6 else socket.AF_INET
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.bind((str(address), 0))
    except OSError:
        return False
    return True
