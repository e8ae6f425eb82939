"""Robot Web Services as ways to a controller: what the bridge has to know of 1.0 and 2.0 before it opens one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from doormill_ros.abb.credentials import load_credentials
from doormill_ros.abb.signal_paths import PARAMETER
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transport_kind import TransportKind, TransportOptions

if TYPE_CHECKING:
    from doormill_ros.abb.transports.rws_http import LinkTimeouts


def _open_rws1(options: TransportOptions) -> Transport:
    from doormill_ros.abb.transports.rws import (
        connect_rws1,  # late: its libraries take a fifth of the bridge's start
    )

    return connect_rws1(
        options.address, load_credentials(), timeouts=_timeouts(options), signal_paths=options.signal_paths
    )


def _open_rws2(options: TransportOptions) -> Transport:
    from doormill_ros.abb.transports.rws import connect_rws2  # late, as above

    return connect_rws2(
        options.address,
        load_credentials(),
        certificate=options.certificate,
        insecure=options.insecure,
        timeouts=_timeouts(options),
        signal_paths=options.signal_paths,
    )


def _timeouts(options: TransportOptions) -> LinkTimeouts:
    from doormill_ros.abb.transports.rws_http import LinkTimeouts  # late, as above

    return LinkTimeouts.within(options.answer)


RWS1 = TransportKind(_open_rws1, address="URL", uses=("manual_mode", PARAMETER))
RWS2 = TransportKind(_open_rws2, address="URL", uses=("certificate", "insecure", "manual_mode", PARAMETER))
