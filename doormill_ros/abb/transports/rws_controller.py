"""Operating mode, drives, execution, override and event log through Robot Web Services."""

from __future__ import annotations

from typing import Any

from doormill_ros.abb.controller_state import AUTOMATIC, ControllerEvent, ControllerReading
from doormill_ros.abb.link_errors import ControllerReplyError
from doormill_ros.abb.transports.rws_dialect import Dialect, whole_number
from doormill_ros.abb.transports.rws_http import RwsHttp

#: Event numbers are 16 bit.
_WRAP = 65536
#: Entries taken in one go; a longer queue comes with the next call.
_BATCH = 20


class RwsController:
    """Reads the controller's state within the session of a transport."""

    def __init__(self, http: RwsHttp, dialect: Dialect) -> None:
        """Read nothing yet."""
        self._http = http
        self._dialect = dialect
        self._last_event: int | None = None

    def read(self, ask_privilege: bool = False) -> ControllerReading:
        """How the controller is now; see `ControllerWatch`."""
        mode = self._value("/rw/panel/opmode", "opmode")
        text = self._value("/rw/panel/speedratio", "speedratio")
        override = whole_number(text)
        if override is None:
            raise ControllerReplyError(
                f"the controller's speed override is {text!r}, a whole number of percent is wanted; check the version"
            )
        return ControllerReading(
            mode,
            self._value(self._dialect.drives, "ctrlstate"),
            self._value("/rw/rapid/execution", "ctrlexecstate"),
            override / 100.0,
            ask_privilege and mode != AUTOMATIC and self._has_privilege(),
        )

    def events(self) -> tuple[ControllerEvent, ...]:
        """New entries of the event log; see `ControllerWatch`."""
        if self._last_event is None:
            self._last_event = self._newest()
            return ()
        found = []
        for _ in range(_BATCH):
            number = (self._last_event + 1) % _WRAP
            entries = self._items(self._dialect.resource(f"/rw/elog/0/{number}", "lang=en"), missing=True)
            if not entries:
                break
            found.append(_event(number, entries[0]))
            self._last_event = number
        return tuple(found)

    def _newest(self) -> int:
        query = "lang=en" if self._dialect.version == 1 else "lang=en&order=lifo"
        entries = self._items(self._dialect.resource("/rw/elog/0", query), accept=self._dialect.log_type)
        titles = (whole_number(str(entry.get("_title", "")).rsplit("/", 1)[-1]) for entry in entries)
        return max((number for number in titles if number is not None), default=0)

    def _has_privilege(self) -> bool:
        """Ask the operator unless that is done; whether he said yes. Each look keeps the privilege alive."""
        try:
            status = self._value("/users/rmmp/poll", "status")
        except ControllerReplyError as error:
            if error.data.get("status") != 500:
                raise
            return False  # RobotWare 8.1.1 has no answer but this to any question for it
        if status not in ("GRANTED", "PENDING"):
            self._http.request(
                "POST",
                self._dialect.resource("/users/rmmp"),
                content="privilege=modify",
                headers={"Content-Type": self._dialect.form_type},
            )
        return status == "GRANTED"

    def _value(self, path: str, key: str) -> str:
        address = self._dialect.resource(path)
        for item in self._items(address):
            if key in item:
                return str(item[key])
        raise ControllerReplyError(f"the controller's answer to {address} has no {key!r}; check the version")

    def _items(self, path: str, missing: bool = False, accept: str = "") -> list[dict[str, Any]]:
        headers = {"Accept": accept} if accept else {}
        response = self._http.request("GET", path, headers=headers, repeat=True)
        if missing and response.status_code in (400, 404):
            return []
        if response.status_code != 200:
            raise ControllerReplyError(
                f"the controller answers {response.status_code} to {path}; check the user's grants and the version",
                status=response.status_code,
            )
        return self._dialect.items(response.content)


def _event(number: int, entry: dict[str, Any]) -> ControllerEvent:
    def whole(key: str) -> int:
        return whole_number(str(entry.get(key, ""))) or 0

    return ControllerEvent(
        number, whole("msgtype"), whole("code"), str(entry.get("title", "")), str(entry.get("desc", ""))
    )
