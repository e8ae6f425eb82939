"""Transports by name: adding one is a new file beside this one and a line in TRANSPORTS."""

from __future__ import annotations

from doormill_ros.abb.link_errors import UnknownTransportError
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transport_kind import TransportKind, TransportOptions
from doormill_ros.abb.transports import rws_kinds, simulated_folder
from doormill_ros.enumeration import enumerated

SIMULATED_TRANSPORT = "simulated_folder"  #: what the bridge uses unless told

TRANSPORTS: dict[str, TransportKind] = {
    SIMULATED_TRANSPORT: simulated_folder.KIND,
    "rws1": rws_kinds.RWS1,
    "rws2": rws_kinds.RWS2,
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
        real = enumerated((other for other, kind in TRANSPORTS.items() if kind.moves_robot), "or")
        raise UnknownTransportError(
            f"transport is {name!r}, which is named {_FORMER[name]!r} now, because no real controller shows its "
            f"signals as files: write that name, or {real} for a real controller",
            name=name,
        )
    if name not in TRANSPORTS:
        raise UnknownTransportError(
            f"transport is {name!r}, allowed are {', '.join(TRANSPORTS)}; correct the bridge's parameter",
            name=name,
        )
    return TRANSPORTS[name].open(options)


def addresses() -> str:
    """What the address of each transport is, in words."""
    words = dict.fromkeys(kind.address for kind in TRANSPORTS.values())
    return ", ".join(
        f"{word} of {enumerated((name for name, kind in TRANSPORTS.items() if kind.address == word), 'and')}"
        for word in words
    )


def users_of(parameter: str) -> str:
    """Which transports use a parameter of the bridge, in words."""
    return enumerated((name for name, kind in TRANSPORTS.items() if parameter in kind.uses), "and")
