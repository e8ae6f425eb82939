"""The secrets that allow orders from the operator's page, and what each allows."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Mapping
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
class Holder:
    """Who a token stands for.

    Attributes:
        role: What the token allows.
        name: Of the person it was given to; empty where a role has one token for all.
    """

    role: Role
    name: str = ""


@dataclass(frozen=True)
class Keys:
    """The tokens by role; None: nobody has that role, beside the people who have it by a token of their own.

    Raises:
        ValueError: One token twice.
    """

    operate: str | None = field(default=None, repr=False)
    engineer: str | None = field(default=None, repr=False)
    people: Mapping[Holder, str] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Keep the holders apart."""
        tokens = [token for token in self._tokens().values() if token]
        if len(set(tokens)) < len(tokens):
            raise ValueError("operate and engineer have one token, or two people; make each with new_token()")

    def __bool__(self) -> bool:
        """Whether anybody may do more than look."""
        return any(self._tokens().values())

    def _tokens(self) -> dict[Holder, str | None]:
        return {Holder(Role.OPERATE): self.operate, Holder(Role.ENGINEER): self.engineer, **self.people}

    def holder(self, header: str | None) -> Holder | None:
        """Who sent this Authorization header; None when it carries none of the tokens."""
        # All are compared whatever the first gives: the time tells nothing.
        found = [holder for holder, token in self._tokens().items() if authorizes(header, token or "")]
        return max(found, key=lambda holder: holder.role, default=None)


def new_token() -> str:
    """A random token short enough to be typed on a tablet."""
    return "".join(secrets.choice(_ALPHABET) for _ in range(_LETTERS))


def authorizes(header: str | None, token: str) -> bool:
    """Whether an Authorization header carries the token; takes as long for any wrong one; an empty token is none."""
    if header is None or header[: len(_SCHEME)].lower() != _SCHEME:
        return False
    return hmac.compare_digest(header[len(_SCHEME) :].strip().encode(), token.encode()) and token != ""
