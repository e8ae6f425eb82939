"""Robot Web Services 2.0: OmniCore controllers with RobotWare 7 and later, https with basic login."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.transports.rws import RwsTransport
from doormill_ros.abb.transports.rws_dialect import RWS2
from doormill_ros.abb.transports.rws_http import LinkTimeouts, RwsHttp, tls_context


def connect_rws2(
    url: str,
    credentials: Credentials,
    certificate: Path | None = None,
    insecure: bool = False,
    timeouts: LinkTimeouts | None = None,
    signal_paths: Mapping[str, str] | None = None,
    poll_interval: float = 0.25,
    subscribe: bool = True,
) -> RwsTransport:
    """A transport to an OmniCore controller; the first operation connects.

    Args:
        url: For example "https://192.168.125.1".
        credentials: A user with the grants to write HOME and I/O.
        certificate: The controller's own certificate as PEM; no other is trusted.
        insecure: Trust any certificate instead.
        timeouts: Limits of an operation.
        signal_paths: `{network}/{device}/{name}` by signal name where the plain name does not do.
        poll_interval: How long the request's last value is good without an event [s].
        subscribe: Listen to events instead of polling alone.

    Raises:
        CertificateError: Neither a certificate nor `insecure`, or the file is no certificate.
    """
    timeouts = timeouts or LinkTimeouts()
    tls = tls_context(certificate, insecure)
    http = RwsHttp(url, credentials, timeouts, digest=False, headers=RWS2.headers, tls=tls)
    return RwsTransport(http, RWS2, timeouts.total, signal_paths, poll_interval, subscribe)
