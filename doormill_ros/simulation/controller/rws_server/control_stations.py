"""Control stations of RobotWare 8: a session is registered with one, and one station at a time may write.

Sources: forms, answers and return codes as a virtual controller with 8.1.1 gave them
(github.com/ichbinmeraj/abb-rws-client, `src/paths/systemMastership.ts`, `src/rws2/core.ts`, `CHANGELOG.md`); what a
station is: developercenter.robotstudio.com, PC SDK, "Control Station Write Access". Whether signals and files need the
access is told nowhere: here they do, and a PIN is the one that the station was registered with first.
"""

from __future__ import annotations

import re

from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    CODE_NO_STATION,
    CODE_NO_WRITE_ACCESS,
    CODE_WRITE_ACCESS_TAKEN,
    Item,
    RefusalError,
)

_ID = re.compile(r"\{[0-9a-fA-F]{8}(-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}\}")
_PENDANT = "{00000000-0000-0000-0000-000000000001}"


class ControlStations:
    """Who is registered, and who may write."""

    def __init__(self) -> None:
        """Nobody is, and nobody may."""
        self._of_session: dict[str, str] = {}
        self._pins: dict[str, str] = {}
        self._writer = ""
        self._held = False

    def register(self, owner: str, form: dict[str, str]) -> None:
        """Bind a session to a remote station, for as long as the session lives."""
        name, station = form.get("control-station-name", ""), form.get("control-station-id", "")
        pin = form.get("pincode", "")
        if not (name and pin):
            raise RefusalError(400, CODE_INVALID, "control-station-name and pincode are required")
        if not _ID.fullmatch(station):
            raise RefusalError(400, CODE_INVALID, "Control station id not allowed")
        if self._pins.setdefault(station, pin) != pin:
            raise RefusalError(403, CODE_INVALID, "pincode is not the control station's")
        self._of_session[owner] = station

    def request(self, owner: str) -> None:
        """Take the write access; what a station holds that has not written yet stays its own."""
        station = self._station(owner)
        if self._held and self._writer != station:
            raise RefusalError(
                403,
                CODE_WRITE_ACCESS_TAKEN,
                "Remote Control Station cannot take SPoC when it is taken",
            )
        self._writer, self._held = station, True

    def release(self, owner: str) -> None:
        """Give it back; no end of a session does that."""
        if not self._held or self._writer != self._station(owner):
            raise RefusalError(403, CODE_NO_WRITE_ACCESS, "The control station does not have SPoC.")
        self._writer, self._held = "", False

    def take_locally(self) -> None:
        """The operator takes it at the pendant, which he may at any time."""
        self._writer, self._held = _PENDANT, True

    def give_locally(self) -> None:
        """The operator gives it back."""
        self._writer, self._held = "", False

    def require(self, owner: str) -> None:
        """Refuse a write of a session whose station may not; one that is let through ends the hold, not the access."""
        if self._writer != self._station(owner):
            raise RefusalError(403, CODE_NO_WRITE_ACCESS, "The control station does not have SPoC.")
        self._held = False

    def status(self) -> Item:
        """Who holds it."""
        values = {
            "control-station-write-access-held": str(self._held).lower(),
            "held-by-control-station-Id": self._writer if self._held else "",
        }
        return Item("controlstation-writeaccess-status", "status", "", values)

    def _station(self, owner: str) -> str:
        if owner not in self._of_session:
            raise RefusalError(403, CODE_NO_STATION, "Session is not part of a Control Station")
        return self._of_session[owner]
