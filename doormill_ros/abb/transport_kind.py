"""What a transport says of itself: how it is opened, what its address means, which options it uses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.abb.transport import Transport

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
        signal_paths: Network, device and name of signals whose plain name does not do, by that name.
    """

    address: str
    certificate: Path | None = None
    insecure: bool = False
    answer: float = ANSWER
    signal_paths: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class TransportKind:
    """One way to a controller, of which its file holds one and the registry a line.

    Attributes:
        open: Opens it; slow libraries are imported in there, because every start of the bridge imports this.
        address: What its address is, for the help: "URL".
        moves_robot: Whether a real robot is at its other end.
        uses: Parameters of the bridge that do something with it beside `address` and `limit.answer`.
    """

    open: Callable[[TransportOptions], Transport]
    address: str
    moves_robot: bool = True
    uses: tuple[str, ...] = ()
