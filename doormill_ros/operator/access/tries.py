"""How often a client may be wrong about a token."""

from __future__ import annotations

import ipaddress
import time
from collections.abc import Callable

FREE = 5  # wrong tokens before the first wait
LONGEST_WAIT = 300.0  # s
FORGOTTEN = 900.0  # s after the last wrong token
CLIENTS = 1000  # remembered


class Tries:
    """Counts wrong tokens by client; from the fifth on each doubles the wait, beginning with a second.

    A right token takes nothing back: who has one could try for another between two uses of his own.

    Args:
        clock: Monotonic time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._wrong: dict[
            str, tuple[int, float]
        ] = {}  # count and time of the last, in the order of that time

    def wait(self, address: str) -> float:
        """For how long no token of this client is looked at [s]; 0 when it may try."""
        count, last = self._known(_client(address))
        if count < FREE:
            return 0.0
        wait = min(2.0 ** min(count - FREE, 30), LONGEST_WAIT)
        return max(last + wait - self._clock(), 0.0)

    def failed(self, address: str) -> None:
        """A wrong token came from this client."""
        client = _client(address)
        count, _ = self._known(client)
        self._wrong.pop(client, None)
        self._wrong[client] = count + 1, self._clock()
        if len(self._wrong) > CLIENTS:
            del self._wrong[next(iter(self._wrong))]

    def _known(self, client: str) -> tuple[int, float]:
        count, last = self._wrong.get(client, (0, 0.0))
        return (count, last) if self._clock() - last < FORGOTTEN else (0, 0.0)


def _client(address: str) -> str:
    """Who is one client: an address, or in version 6 the network of 64 bits that one machine can use up."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address):
        return str(found)
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    return str(ipaddress.ip_network((found, 64), strict=False))
