"""Web sessions of the simulated controller: few of them, idle ones end, cookies tell them apart."""

from __future__ import annotations

import hashlib
import secrets
import time
from dataclasses import dataclass, field

SESSION_COOKIE = "-http-session-"
ABB_COOKIE = "ABBCX"
REALM = "validusers@robapi.abb"


@dataclass
class Session:
    """One client.

    Attributes:
        number: Value of the ABBCX cookie.
        token: Value of the session cookie.
        last_used: Monotonic time of the last request [s].
        sockets: Open event streams; a session with one does not idle out.
    """

    number: str
    token: str
    last_used: float
    sockets: int = 0


@dataclass
class SessionTable:
    """All sessions of one controller.

    Attributes:
        limit: Sessions at a time; one more is answered 503.
        idle_expiry: A session unused for so long ends [s].
    """

    limit: int = 70
    idle_expiry: float = 300.0
    sessions: dict[str, Session] = field(default_factory=dict)
    created: int = 0

    def find(self, cookies: dict[str, str]) -> Session | None:
        """The live session the cookies belong to."""
        self._drop_idle()
        session = self.sessions.get(cookies.get(SESSION_COOKIE, ""))
        if session is None:
            number = cookies.get(ABB_COOKIE, "")
            session = next((s for s in self.sessions.values() if s.number == number), None)
        if session is not None:
            session.last_used = time.monotonic()
        return session

    def create(self) -> Session | None:
        """A new session, None when there are too many."""
        self._drop_idle()
        if len(self.sessions) >= self.limit:
            return None
        self.created += 1
        session = Session(str(self.created), secrets.token_hex(12), time.monotonic())
        self.sessions[session.token] = session
        return session

    def end(self, session: Session) -> None:
        """Forget a session."""
        self.sessions.pop(session.token, None)

    def end_all(self) -> None:
        """Forget every session, as after a restart of the controller."""
        self.sessions.clear()

    def _drop_idle(self) -> None:
        now = time.monotonic()
        old = [s for s in self.sessions.values() if not s.sockets and now - s.last_used > self.idle_expiry]
        for session in old:
            self.end(session)


class DigestGate:
    """HTTP digest authentication (RFC 2617, MD5, qop auth) as IRC5 asks for it."""

    def __init__(self, user: str, password: str, nonce_life: float = 300.0) -> None:
        """Keep the one account.

        Args:
            user: Name.
            password: Password.
            nonce_life: Time after which a challenge must be renewed [s].
        """
        self._secret = _md5(f"{user}:{REALM}:{password}")
        self._user = user
        self._nonce_life = nonce_life
        self._nonces: dict[str, float] = {}

    def challenge(self, stale: bool = False) -> str:
        """Value of a WWW-Authenticate header."""
        nonce = secrets.token_hex(16)
        self._nonces[nonce] = time.monotonic()
        suffix = ", stale=true" if stale else ""
        return f'Digest realm="{REALM}", domain="/", qop="auth", nonce="{nonce}", algorithm=MD5{suffix}'

    def forget(self) -> None:
        """Invalidate all challenges."""
        self._nonces.clear()

    def check(self, header: str, method: str) -> tuple[bool, bool]:
        """Whether an Authorization header is right, and whether just its nonce is too old."""
        scheme, _, rest = header.partition(" ")
        if scheme.lower() != "digest":
            return False, False
        fields = parse_digest(rest)
        nonce = fields.get("nonce", "")
        inner = _md5(f"{method}:{fields.get('uri', '')}")
        middle = ":".join([nonce, fields.get("nc", ""), fields.get("cnonce", ""), fields.get("qop", "")])
        right = fields.get("username") == self._user and secrets.compare_digest(
            fields.get("response", ""), _md5(f"{self._secret}:{middle}:{inner}")
        )
        born = self._nonces.get(nonce)
        fresh = born is not None and time.monotonic() - born < self._nonce_life
        return right and fresh, right and not fresh


def parse_digest(text: str) -> dict[str, str]:
    """Fields of a digest header; commas inside quotes belong to the value."""
    fields, key, value, quoted, in_value = {}, "", "", False, False
    for char in text + ",":
        if char == '"':
            quoted = not quoted
        elif char == "," and not quoted:
            fields[key.strip().lower()] = value.strip()
            key, value, in_value = "", "", False
        elif char == "=" and not in_value:
            in_value = True
        elif in_value:
            value += char
        else:
            key += char
    return fields


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
