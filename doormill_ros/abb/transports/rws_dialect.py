"""Where version 1.0 (IRC5) and 2.0 (OmniCore) of the web services differ on the wire."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from doormill_ros.abb.link_errors import ControllerReplyError

_FORM = "application/x-www-form-urlencoded"


LONGEST_NUMBER = 10  #: digits that the controller has for one


def whole_number(text: str) -> int | None:
    """The number in an answer; None for what is none, or longer than any the controller has."""
    return int(text) if text.isascii() and text.isdecimal() and len(text) <= LONGEST_NUMBER else None


@dataclass(frozen=True)
class Dialect:
    """One version's spelling.

    Attributes:
        version: 1 or 2.
        subprotocol: Name the event stream insists on.
        headers: Sent with every request.
        form_type: Content type of a form.
        file_type: Content type of an upload.
        encrypted: https with basic login, where the other has http with digest login.
        drives: Where the state of the drives is read.
        log_type: Media type in which the event log comes newest first, "" where it always does.
    """

    version: int
    subprotocol: str
    headers: dict[str, str]
    form_type: str
    file_type: str
    encrypted: bool
    drives: str
    log_type: str

    @property
    def change_headers(self) -> dict[str, str]:
        """For a change without a body: 2.0 answers 406 to one without these."""
        return {"Content-Type": self.form_type, "Content-Length": "0"}

    def resource(self, path: str, query: str = "") -> str:
        """A resource that both versions have at the same place."""
        wanted = "&".join(part for part in (query, "json=1" if self.version == 1 else "") if part)
        return f"{path}?{wanted}" if wanted else path

    def signal(self, path: str) -> str:
        """Where a signal is read; `path` is `{name}` or `{network}/{device}/{name}`."""
        address = f"/rw/iosystem/signals/{quote(path)}"
        return f"{address}?json=1" if self.version == 1 else address

    def set_signal(self, path: str) -> str:
        """Where a signal is written."""
        address = f"/rw/iosystem/signals/{quote(path)}"
        return f"{address}?action=set&json=1" if self.version == 1 else f"{address}/set-value"

    def file(self, name: str) -> str:
        """A file in HOME; 1.0 wants a literal "$" and refuses "%24", 2.0 wants none."""
        return f"/fileservice/{'$home' if self.version == 1 else 'HOME'}/{quote(name)}"

    def subscription_body(self, resource: str) -> str:
        """Body that subscribes to one signal with high priority; the ";" stays literal."""
        return f"resources=1&1={resource}&1-p=2"

    def items(self, body: bytes) -> list[dict[str, Any]]:
        """The list in a JSON answer.

        Raises:
            ControllerReplyError: It holds none.
        """
        try:
            document = json.loads(body)
            found = document["_embedded"]["_state"] if self.version == 1 else document["state"]
            if isinstance(found, list) and all(isinstance(item, dict) for item in found):
                # JSON can spell halves of characters, which no message and no log can hold.
                json.dumps(found, ensure_ascii=False).encode()
                return found
        except (ValueError, KeyError, TypeError, RecursionError):
            pass
        raise ControllerReplyError(
            f"the controller's answer holds no list of states ({body[:80]!r}); check that version "
            f"{self.version}.0 is the controller's version of Robot Web Services"
        )

    def error_code(self, body: bytes) -> int:
        """The controller's return code in a refusal, 0 when there is none."""
        try:
            document = json.loads(body)
            status = document["_embedded"]["status"] if self.version == 1 else document["status"]
            return int(status["code"])
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            return 0


RWS1 = Dialect(
    1,
    "robapi2_subscription",
    {},
    _FORM,
    "application/octet-stream",
    encrypted=False,
    drives="/rw/panel/ctrlstate",
    log_type="",
)
RWS2 = Dialect(
    2,
    "rws_subscription",
    {"Accept": "application/hal+json;v=2.0"},
    f"{_FORM};v=2.0",
    "text/plain;v=2.0",
    encrypted=True,
    drives="/rw/panel/ctrl-state",
    log_type="application/hal+json;v=2.1",
)
