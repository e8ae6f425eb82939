"""The secret that allows control from the operator's page."""

from __future__ import annotations

import hmac
import secrets

#: Without characters that are read or typed for one another.
_ALPHABET = "abcdefghjkmnpqrstuvwxyz23456789"
_LETTERS = 20  # 99 bits
_SCHEME = "bearer "


def new_token() -> str:
    """A random token short enough to be typed on a tablet."""
    return "".join(secrets.choice(_ALPHABET) for _ in range(_LETTERS))


def authorizes(header: str | None, token: str) -> bool:
    """Whether an Authorization header carries the token; takes as long for any wrong one."""
    if header is None or header[: len(_SCHEME)].lower() != _SCHEME:
        return False
    return hmac.compare_digest(header[len(_SCHEME) :].strip().encode(), token.encode())
