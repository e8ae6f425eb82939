"""Robot Web Services as a transport: what 1.0 (IRC5) and 2.0 (OmniCore) have in common."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import httpx

from doormill_ros.abb import signals
from doormill_ros.abb.analog_inputs import decimal
from doormill_ros.abb.controller_state import ControllerEvent, ControllerReading
from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.link_errors import (
    ControllerReplyError,
    DownloadError,
    FileMissingError,
    RemoveError,
    SignalAccessError,
    SignalReadError,
    SignalWriteError,
    UnknownSignalError,
    UploadError,
    WriteAccessError,
)
from doormill_ros.abb.transport import check_file_name
from doormill_ros.abb.transports.control_station import ControlStation
from doormill_ros.abb.transports.rws_address import tls_context
from doormill_ros.abb.transports.rws_controller import RwsController
from doormill_ros.abb.transports.rws_dialect import RWS1, RWS2, Dialect, whole_number
from doormill_ros.abb.transports.rws_events import RwsEvents
from doormill_ros.abb.transports.rws_http import LinkTimeouts, RwsHttp

#: Return codes of a write that access level or operating mode forbid: the one of live captures of RobotWare 6.16 and
#: 7.21 (github.com/ichbinmeraj/abb-rws-client, tests/fixtures/errors), and the one of ros-industrial/abb_librws#73.
REJECTED = (-1073445881, -1073414145)
#: Codes of "held by somebody else" and "mastership is needed", from the same captures.
MASTERSHIP = (-1073445862, -1073445859)


class RwsTransport:
    """Signals and files through one web session; made by `connect_rws`.

    Attributes:
        in_doubt_time: How long a request whose connection broke may still be carried out [s].
        events: What reports edges of the request; None where it is polled alone.
    """

    def __init__(
        self,
        http: RwsHttp,
        dialect: Dialect,
        total_timeout: float,
        signal_paths: Mapping[str, str] | None = None,
        poll_interval: float = 0.25,
        subscribe: bool = True,
        station: ControlStation | None = None,
    ) -> None:
        """Begin to subscribe in the background; the controller need not be reachable yet.

        Args:
            http: The session.
            dialect: Version of the web services.
            total_timeout: Limit of one operation [s].
            signal_paths: `{network}/{device}/{name}` by signal name where the plain name does not do.
            poll_interval: How long the request's last value is good without an event [s].
            subscribe: Listen to events; without them the request is polled alone.
            station: Takes the write access where a controller wants it.
        """
        self._http = http
        self._station = station
        self._dialect = dialect
        # Nothing documented bounds how long a controller may sit on a request whose connection broke;
        # once more the limit of an operation has to do, and the robot program checks what it reads.
        self.in_doubt_time = total_timeout
        self._paths = dict(signal_paths or {})
        self._poll_interval = poll_interval
        self._woken = threading.Event()
        self._request_level = False
        self._asked_at = float("-inf")
        self._controller = RwsController(http, dialect)
        self.events: RwsEvents | None = None
        if subscribe:
            self.events = RwsEvents(http, dialect, self._path(signals.REQUEST), self._woken)
            self.events.start()

    def __repr__(self) -> str:
        return f"RwsTransport({self._http.url!r}, version={self._dialect.version})"

    def read_request(self) -> bool:
        """The next reported edge, or the request's value, at most a polling interval old."""
        edge = self.events.next_edge() if self.events is not None else None
        if edge is not None:
            self._request_level = edge
            # An event may be older than the last answer; ask again soon.
            self._asked_at = min(self._asked_at, time.monotonic() - 0.5 * self._poll_interval)
        elif time.monotonic() - self._asked_at >= self._poll_interval:
            self._request_level = self.read_signal(signals.REQUEST)
        return self._request_level

    def read_ready(self) -> bool:
        """The ready signal as the controller has it."""
        return self.read_signal(signals.READY)

    def read_signal(self, name: str) -> bool:
        """Any signal as the controller has it."""
        level = self._read_value(name)
        if level not in (0, 1):
            raise SignalReadError(
                f"signal {name} has no value 0 or 1 in the controller's answer; it must be a digital signal",
                signal=name,
            )
        if name == signals.REQUEST:
            self._asked_at = time.monotonic()
        return level == 1

    def set_ready(self, value: bool) -> None:
        """Write the ready signal; its access level must be "All"."""
        self._write_value(signals.READY, int(value))

    def read_number(self, name: str) -> int:
        """A group signal's number."""
        return self._read_value(name)

    def read_analog(self, name: str) -> float:
        """An analog signal in the unit of its configuration (`lvalue`)."""
        value = decimal(text := self._read_text(name))
        if value is None:
            raise SignalReadError(
                f"signal {name} is {text[:20]!r} in the controller's answer; it must be an analog signal",
                signal=name,
            )
        return value

    def write_number(self, name: str, value: int) -> None:
        """Write a group signal; its access level must be "All"."""
        self._write_value(name, value)

    def write_file(self, name: str, data: bytes) -> None:
        """Upload; the controller writes in place, so the file is half there for a moment."""
        response = self._change(
            "PUT",
            self._dialect.file(check_file_name(name)),
            content=data,
            headers={"Content-Type": self._dialect.file_type},
        )
        if response.status_code not in (200, 201, 204):
            raise UploadError(
                f"{name} cannot be uploaded (status {response.status_code}); check the controller's disk "
                "space and the user's grant to write HOME",
                file=name,
                status=response.status_code,
            )

    def read_file(self, name: str) -> bytes:
        """Download."""
        response = self._http.request(
            "GET", self._dialect.file(check_file_name(name)), headers={"Accept": "*/*"}, repeat=True
        )
        if response.status_code == 404:
            raise FileMissingError(f"{name} is not in the controller's HOME; write it first", file=name)
        if response.status_code != 200:
            raise DownloadError(
                f"{name} cannot be read back (status {response.status_code}); check the user's "
                "grant to read HOME",
                file=name,
                status=response.status_code,
            )
        return response.content

    def remove_file(self, name: str) -> None:
        """Delete; a missing file is no error."""
        response = self._change(
            "DELETE",
            self._dialect.file(check_file_name(name)),
            headers=self._dialect.change_headers,
            repeat=True,
        )
        if response.status_code not in (200, 204, 404):
            raise RemoveError(
                f"{name} cannot be removed (status {response.status_code}); check the user's "
                "grant to write HOME",
                file=name,
                status=response.status_code,
            )

    def read_controller(self, ask_privilege: bool = False) -> ControllerReading:
        """Operating mode, drives, execution and override."""
        return self._controller.read(ask_privilege)

    def read_events(self) -> tuple[ControllerEvent, ...]:
        """New entries of the event log."""
        return self._controller.events()

    def wait(self, timeout: float) -> None:
        """Sleep until an edge is reported, at most a polling interval."""
        if self._woken.wait(max(0.0, min(timeout, self._poll_interval))):
            self._woken.clear()

    def wake(self) -> None:
        """End a `wait`."""
        self._woken.set()

    def close(self) -> None:
        """Unsubscribe, log out and close."""
        if self.events is not None:
            self.events.close()
        self._http.close(logout=self._log_out)

    def _log_out(self) -> None:
        if self._station is not None:
            self._station.give_back()
        self._http.request("GET", "/logout")

    def _change(
        self,
        method: str,
        path: str,
        content: bytes | str | None = None,
        headers: dict[str, str] | None = None,
        repeat: bool = False,
        once: bool = False,
    ) -> httpx.Response:
        """Send a change; one that was refused for want of write access is sent again once this PC has that.

        Raises:
            WriteAccessError: There is none to be had, or the change was to be sent `once`: the access is here now, and
                whoever wants the change has to look again first.
            LinkError: The leaf of the phase that failed.
        """
        response = self._http.request(
            method, path, content=content, headers=headers, repeat=repeat, once=once
        )
        if self._station is None or not self._station.misses_access(response):
            return response
        self._station.take()
        if once:
            raise WriteAccessError(
                "the controller's write access had gone to another control station, and is here again; take a new "
                "picture of the door"
            )
        return self._http.request(method, path, content=content, headers=headers, repeat=repeat)

    def _read_value(self, name: str) -> int:
        level = whole_number(self._read_text(name))
        if level is None:
            raise SignalReadError(
                f"signal {name} has no whole number in the controller's answer; it must be a digital or group signal",
                signal=name,
            )
        return level

    def _read_text(self, name: str) -> str:
        """Level of a signal as the controller writes it, "" where it tells none."""
        response = self._http.request("GET", self._dialect.signal(self._path(name)), repeat=True)
        self._check_signal(response, name, "read")
        return next((str(i["lvalue"]) for i in self._dialect.items(response.content) if "lvalue" in i), "")

    def _write_value(self, name: str, value: int) -> None:
        response = self._change(
            "POST",
            self._dialect.set_signal(self._path(name)),
            content=f"lvalue={value}",
            headers={"Content-Type": self._dialect.form_type},
            repeat=not value,  # lowering twice, or late, does no harm
            once=bool(value),
        )
        self._check_signal(response, name, "written")

    def _path(self, name: str) -> str:
        return self._paths.get(name, name)

    def _check_signal(self, response: httpx.Response, name: str, doing: str) -> None:
        status = response.status_code
        if status in (200, 204):
            return
        code = self._dialect.error_code(response.content)
        if code in REJECTED:
            raise SignalAccessError(
                f"signal {name} cannot be {doing} (code {code}): its access level is not 'All', or the controller is "
                "in manual mode; set Access Level All in the I/O configuration, or cross-connect a virtual signal of "
                "that level, and turn the controller to automatic",
                signal=name,
                controller_code=code,
            )
        if code in MASTERSHIP:
            raise SignalAccessError(
                f"signal {name} cannot be {doing} (code {code}): somebody else may write on this controller now; "
                "release the write access of RobotStudio or of the other client",
                signal=name,
                controller_code=code,
            )
        if status == 404:
            raise UnknownSignalError(
                f"the controller has no signal {self._path(name)}; add it to the I/O configuration or "
                "tell its network and device in the bridge's parameter signal_paths",
                signal=name,
            )
        leaf = {"read": SignalReadError, "written": SignalWriteError}.get(doing, ControllerReplyError)
        raise leaf(
            f"signal {name} cannot be {doing} (status {status}, code {code}); look the code up in the "
            "controller's event log",
            signal=name,
            status=status,
            controller_code=code,
        )


def connect_rws(
    dialect: Dialect,
    url: str,
    credentials: Credentials,
    *,
    certificate: Path | None = None,
    insecure: bool = False,
    timeouts: LinkTimeouts | None = None,
    signal_paths: Mapping[str, str] | None = None,
    poll_interval: float = 0.25,
    subscribe: bool = True,
) -> RwsTransport:
    """A transport to a controller; the first operation connects.

    Args:
        dialect: RWS1 for IRC5 with RobotWare 6.08 and later: http with digest login. RWS2 for OmniCore with
            RobotWare 7 and later: https with basic login.
        url: For example "http://192.168.125.1", the WAN port's address.
        credentials: A user with the grants to write HOME and I/O; for RobotWare 8 with a PIN.
        certificate: Of RWS2: the controller's own certificate as PEM; no other is trusted.
        insecure: Of RWS2: trust any certificate instead.
        timeouts: Limits of an operation.
        signal_paths: `{network}/{device}/{name}` by signal name where the plain name does not do.
        poll_interval: How long the request's last value is good without an event [s].
        subscribe: Listen to events instead of polling alone.

    Raises:
        ConnectError: The address is no address.
        CertificateError: With RWS2 neither a certificate nor `insecure`, or the file is no certificate.
    """
    timeouts = timeouts or LinkTimeouts()
    tls = tls_context(certificate, insecure) if dialect.encrypted else None
    http = RwsHttp(url, credentials, timeouts, not dialect.encrypted, dialect.headers, tls)
    station = ControlStation(http, dialect, credentials) if dialect.version == 2 else None
    return RwsTransport(http, dialect, timeouts.total, signal_paths, poll_interval, subscribe, station)


connect_rws1 = partial(connect_rws, RWS1)
connect_rws2 = partial(connect_rws, RWS2)
