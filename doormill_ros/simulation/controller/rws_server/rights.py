"""Who may write: mastership or control stations, and in manual mode the privilege that the operator grants."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from doormill_ros.simulation.controller.operation.states import OperatingMode
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.control_stations import ControlStations
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_HELD,
    CODE_INVALID,
    CODE_NO_MASTERSHIP,
    CODE_NO_RESOURCE,
    CODE_REJECTED,
    Item,
    RefusalError,
)

#: Domains of mastership; what RAPID data and program pointer belong to stands first.
DOMAINS = {1: ("rapid", "cfg", "motion"), 2: ("edit", "motion")}
#: A privilege that nobody polls ends after this time [s].
PRIVILEGE_LIFE = 10.0
#: RobotWare that has control stations in place of mastership.
CONTROL_STATIONS_SINCE = 8


@dataclass
class _Privilege:
    owner: str
    asked_at: float


class Rights:
    """Mastership and remote privilege of one controller; owners are sessions.

    Attributes:
        stations: In place of mastership, from RobotWare 8 on; None before.
    """

    def __init__(
        self, cabinet: Cabinet, version: int, alive: Callable[[str], bool], robotware: int = 0
    ) -> None:
        """Nobody holds anything.

        Args:
            cabinet: Whose operating mode counts.
            version: 1 or 2.
            alive: Whether a session still lives; what a dead one held is free.
            robotware: Major version; 0 for the one that goes with `version`.
        """
        self.stations = ControlStations() if robotware >= CONTROL_STATIONS_SINCE else None
        self._cabinet = cabinet
        self._alive = alive
        self._held: dict[str, str] = {}
        self._privilege: _Privilege | None = None
        self._version = version
        self._domains = DOMAINS[version]

    def request(self, domain: str, owner: str) -> None:
        """Take mastership of a domain, of all when it is empty."""
        self._require_domains()
        wanted = self._named(domain)
        self.require_write(owner)
        if any(self._holder(name) is not None for name in wanted):
            raise RefusalError(403, CODE_HELD, "Requested resource is held by someone else")
        self._held.update(dict.fromkeys(wanted, owner))

    def release(self, domain: str, owner: str) -> None:
        """Give mastership back; without effect where it is not held."""
        self._require_domains()
        for name in self._named(domain):
            if self._held.get(name) == owner:
                del self._held[name]

    def holder(self) -> str | None:
        """Session that holds the first domain."""
        return self._holder(self._domains[0])

    def require_mastership(self, owner: str, implicit: bool) -> None:
        """Refuse a change of program or data: 1.0 takes a free mastership by itself, 2.0 where it is asked to."""
        self.require_write(owner)
        holder = self.holder()
        if self.stations is not None or holder == owner:
            return
        if holder is not None:
            raise RefusalError(403, CODE_HELD, "Requested resource is held by someone else")
        if self._version == 2 and not implicit:
            raise RefusalError(
                403, CODE_NO_MASTERSHIP, "The user does not have required mastership for the operation."
            )

    def require_write(self, owner: str) -> None:
        """Refuse any write to whose control station may not, and in manual mode to who has no privilege."""
        self.require_station(owner)
        if self._cabinet.controller.panel.state.mode is OperatingMode.AUTO:
            return
        if self._privilege_of(owner) != "GRANTED":
            raise RefusalError(403, CODE_REJECTED, "Rejected")

    def require_station(self, owner: str) -> None:
        """Refuse a write to whose control station may not, where there are control stations."""
        if self.stations is not None:
            self.stations.require(owner)

    def control_stations(self) -> ControlStations:
        """The control stations; there are none before RobotWare 8."""
        if self.stations is None:
            raise RefusalError(404, CODE_NO_RESOURCE, "no resource /rw/controlstation")
        return self.stations

    # The remote privilege

    def ask(self, owner: str, privilege: str) -> None:
        """Ask the operator."""
        self._require_privileges()
        if privilege not in ("modify", "exec"):
            raise RefusalError(400, CODE_INVALID, f"privilege {privilege!r}")
        if self._privilege is not None and self._privilege.owner != owner and self._fresh():
            raise RefusalError(403, CODE_HELD, "Requested resource is held by someone else")
        self._privilege = _Privilege(owner, time.monotonic())

    def poll(self, owner: str) -> Item:
        """What became of it; asking keeps it alive."""
        self._require_privileges()
        status = self._privilege_of(owner)
        if self._privilege is not None and self._privilege.owner == owner:
            self._privilege.asked_at = time.monotonic()
        return Item("user-rmmp-poll", "rmmp", "", {"code": "0", "status": status})

    def privilege(self, owner: str) -> Item:
        """Who has the privilege."""
        self._require_privileges()
        granted = self._privilege_of(owner) == "GRANTED"
        values = {"privilege": "modify" if granted else "none", "rmmpheldbyme": str(granted).lower()}
        return Item("user-rmmp", "rmmp", "", values)

    def cancel(self, owner: str) -> None:
        """Give the privilege back."""
        self._require_privileges()
        if self._privilege is not None and self._privilege.owner == owner:
            self._privilege = None

    def _privilege_of(self, owner: str) -> str:
        if self._privilege is None or self._privilege.owner != owner or not self._fresh():
            return "NO SUCH REQUEST"
        return self._cabinet.answers_privilege

    def _require_privileges(self) -> None:
        if self.stations is not None:  # 8.1.1 answers so to every verb
            raise RefusalError(500, CODE_INVALID, "Internal server error")

    def _require_domains(self) -> None:
        if self.stations is not None:
            raise RefusalError(410, CODE_NO_RESOURCE, "Gone")

    def _fresh(self) -> bool:
        held = self._privilege
        return held is not None and time.monotonic() - held.asked_at < PRIVILEGE_LIFE

    def _named(self, domain: str) -> tuple[str, ...]:
        if domain and domain not in self._domains:
            raise RefusalError(404, CODE_INVALID, f"no mastership domain {domain}")
        return (domain,) if domain else self._domains

    def _holder(self, domain: str) -> str | None:
        owner = self._held.get(domain)
        return owner if owner is not None and self._alive(owner) else None
