"""Robot Web Services 1.0: IRC5 controllers with RobotWare 6.08 and later, http with digest login."""

from __future__ import annotations

from collections.abc import Mapping

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.abb.transports.rws_dialect import RWS1
from doormill_ros.abb.transports.rws_http import LinkTimeouts, RwsHttp


def connect_rws1(
    url: str,
    credentials: Credentials,
    timeouts: LinkTimeouts | None = None,
    signal_paths: Mapping[str, str] | None = None,
    poll_interval: float = 0.25,
    subscribe: bool = True,
) -> RwsTransport:
    """A transport to an IRC5 controller; the first operation connects.

    Args:
        url: For example "http://192.168.125.1", the WAN port's address.
        credentials: A user with the grants to write HOME and I/O.
        timeouts: Limits of an operation.
        signal_paths: `{network}/{device}/{name}` by signal name where the plain name does not do.
        poll_interval: How long the request's last value is good without an event [s].
        subscribe: Listen to events instead of polling alone.
    """
    timeouts = timeouts or LinkTimeouts()
    http = RwsHttp(url, credentials, timeouts, digest=True, headers=RWS1.headers)
    return RwsTransport(http, RWS1, timeouts.total, signal_paths, poll_interval, subscribe)
