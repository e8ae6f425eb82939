"""The secrets that allow orders from the operator's page, and what each allows."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from enum import IntEnum

#: Without characters that are read or typed for one another.
_ALPHABET = "abcdefghjkmnpqrstuvwxyz23456789"
_LETTERS = 20  # 99 bits
_SCHEME = "bearer "


class Role(IntEnum):
    """What somebody may do; each may do what those before it may."""

    LOOK = 0
    """See the page; needs no token."""
    OPERATE = 1
    """Start and cancel runs."""
    ENGINEER = 2
    """Put models in use and take them back, read the audit log."""

    @property
    def word(self) -> str:
        """Its name in sentences and files."""
        return self.name.lower()


@dataclass(frozen=True)
class Keys:
    """The tokens by role; None: nobody has that role.

    Raises:
        ValueError: One token for both roles.
    """

    operate: str | None = field(default=None, repr=False)
    engineer: str | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        """Keep the roles apart."""
        if self.operate and self.operate == self.engineer:
            raise ValueError("operate and engineer have one token; make each with new_token()")

    def __bool__(self) -> bool:
        """Whether anybody may do more than look."""
        return bool(self.operate or self.engineer)

    def role(self, header: str | None) -> Role | None:
        """Role of who sent this Authorization header; None when it carries none of the tokens."""
        # Both are compared whatever the first gives: the time tells nothing.
        operate, engineer = authorizes(header, self.operate or ""), authorizes(header, self.engineer or "")
        if engineer:
            return Role.ENGINEER
        return Role.OPERATE if operate else None


def new_token() -> str:
    """A random token short enough to be typed on a tablet."""
    return "".join(secrets.choice(_ALPHABET) for _ in range(_LETTERS))


def authorizes(header: str | None, token: str) -> bool:
    """Whether an Authorization header carries the token; takes as long for any wrong one; an empty token is none."""
    if header is None or header[: len(_SCHEME)].lower() != _SCHEME:
        return False
    return hmac.compare_digest(header[len(_SCHEME) :].strip().encode(), token.encode()) and token != ""
