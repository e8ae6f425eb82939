"""RobotWare 8's write access: this PC as a remote control station of the controller.

Sources: forms, answers and codes of RobotWare 8.1.1 as github.com/ichbinmeraj/abb-rws-client met them
(`src/paths/systemMastership.ts`, `CHANGELOG.md`); what a station is: developercenter.robotstudio.com, PC SDK, "Control
Station Write Access".
"""

from __future__ import annotations

import contextlib
import socket
import uuid
from urllib.parse import urlencode

import httpx

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.link_errors import LinkError, WriteAccessError
from doormill_ros.abb.transports.rws_dialect import Dialect
from doormill_ros.abb.transports.rws_http import RwsHttp

_NO_STATION, _NO_ACCESS, _TAKEN = -1073435871, -1073435873, -1073435870
#: Codes of a write that was not done because this PC may not write.
MISSING = (_NO_STATION, _NO_ACCESS)
_ROOT = "/rw/controlstation"


class ControlStation:
    """Takes the write access when a write was refused for want of it, and gives it back at the end.

    It is not asked for before it is missed, so that controllers without stations see nothing of it. The id is the same
    after a restart of this PC's process: what a killed one held is its own still, and no logout gives it back.

    Args:
        http: The session.
        dialect: Version 2.0.
        credentials: With the PIN.
    """

    def __init__(self, http: RwsHttp, dialect: Dialect, credentials: Credentials) -> None:
        self._http = http
        self._dialect = dialect
        self._credentials = credentials
        self._asked = False

    @property
    def id(self) -> str:
        """GUID in braces, of this PC and this controller."""
        name = f"doormill://{socket.gethostname()}/{self._http.url}"
        return f"{{{uuid.uuid5(uuid.NAMESPACE_URL, name)}}}"

    def misses_access(self, response: httpx.Response) -> bool:
        """Whether a change was refused, and not done, because this PC may not write now."""
        return response.status_code == 403 and self._dialect.error_code(response.content) in MISSING

    def take(self) -> None:
        """Register this session and take the write access.

        Raises:
            WriteAccessError: No PIN was given, or another station holds the access.
            LinkError: The controller cannot be asked.
        """
        pin = self._credentials.reveal_pin()
        if not pin:
            raise WriteAccessError(
                "the controller has RobotWare 8 and wants a PIN of the control station that this PC is; set "
                "DOORMILL_CONTROLLER_PIN, or write pin: into the file with user and password"
            )
        self._asked = True
        station = {"control-station-name": "doormill", "control-station-id": self.id, "pincode": pin}
        self._require(
            self._post("register/remote", urlencode(station)), "register this PC as a control station"
        )
        self._require(self._post("writeaccess/request"), "take the write access")

    def give_back(self) -> None:
        """Release what was taken; a write has done that already, which is no error."""
        if self._asked:
            with contextlib.suppress(LinkError):
                self._post("writeaccess/release")

    def _post(self, path: str, content: str = "") -> httpx.Response:
        headers = self._dialect.change_headers if not content else {"Content-Type": self._dialect.form_type}
        return self._http.request("POST", f"{_ROOT}/{path}", content=content, headers=headers, repeat=True)

    def _require(self, response: httpx.Response, doing: str) -> None:
        if response.status_code in (200, 201, 204):
            return
        code = self._dialect.error_code(response.content)
        if code == _TAKEN:
            raise WriteAccessError(
                "another control station holds the controller's write access (code "
                f"{code}); let its operator release it at the pendant, in RobotStudio or at the other client",
                controller_code=code,
            )
        raise WriteAccessError(
            f"the controller does not let this PC {doing} (status {response.status_code}, code {code}); check the "
            "PIN and the user's grants",
            status=response.status_code,
            controller_code=code,
        )
