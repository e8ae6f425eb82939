"""User and password of a controller: from the environment or a private file, and from nowhere else.

They are no node parameters: those are readable by everybody on the graph and end up in bags and logs.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from doormill_ros.abb.link_errors import (
    CredentialsFormatError,
    CredentialsMissingError,
    CredentialsPermissionError,
)
from doormill_ros.files import NotPrivateError, read_private
from doormill_ros.yaml_text import parse

USER_VARIABLE = "DOORMILL_CONTROLLER_USER"
PASSWORD_VARIABLE = "DOORMILL_CONTROLLER_PASSWORD"
PIN_VARIABLE = "DOORMILL_CONTROLLER_PIN"
FILE_VARIABLE = "DOORMILL_CONTROLLER_CREDENTIALS"
_MAX_SIZE = 10_000


class Credentials:
    """A user, a password and a PIN that show in no text made of them and cannot be pickled."""

    __slots__ = ("_password", "_pin", "user")

    def __init__(self, user: str, password: str, pin: str = "") -> None:
        self.user = user
        self._password = password
        self._pin = pin

    def reveal(self) -> str:
        """The password, for the login alone."""
        return self._password

    def reveal_pin(self) -> str:
        """The PIN of this PC's control station, which RobotWare 8 alone wants; empty without one."""
        return self._pin

    def __repr__(self) -> str:
        return f"Credentials({self.user!r}, ***)"

    def __reduce__(self) -> str:
        raise TypeError("credentials must not be stored")


def load_credentials(environment: Mapping[str, str] = os.environ, file: Path | None = None) -> Credentials:
    """Find the credentials.

    The variables DOORMILL_CONTROLLER_USER and DOORMILL_CONTROLLER_PASSWORD, for RobotWare 8 with
    DOORMILL_CONTROLLER_PIN, win; then the file, given or named by DOORMILL_CONTROLLER_CREDENTIALS, YAML with `user:`,
    `password:` and perhaps `pin:`, mode 600.

    Args:
        environment: Where the variables are looked up.
        file: The file, instead of the one the variable names.

    Returns:
        The credentials.

    Raises:
        CredentialsMissingError: Neither variables nor a file.
        CredentialsPermissionError: Others may read the file, or it belongs to somebody else.
        CredentialsFormatError: The file is not as described.
    """
    user, password = environment.get(USER_VARIABLE), environment.get(PASSWORD_VARIABLE)
    if user and password:
        return Credentials(user, password, environment.get(PIN_VARIABLE, ""))
    named = environment.get(FILE_VARIABLE)
    path = file if file is not None else Path(named) if named else None
    if path is None:
        raise CredentialsMissingError(
            f"no controller credentials: set {USER_VARIABLE} and {PASSWORD_VARIABLE}, or let {FILE_VARIABLE} "
            "name a file with 'user:' and 'password:' that only you may read"
        )
    return _parse(path, _read_private(path))


def _read_private(path: Path) -> bytes:
    try:
        return read_private(path, _MAX_SIZE + 1)
    except NotPrivateError as error:
        told = f"credentials file {path} {error}"
        if error.mode:
            told += f": run 'chmod 600 {path}' and change the password, others may have read it"
            raise CredentialsPermissionError(told, path=str(path), mode=error.mode) from None
        raise CredentialsPermissionError(
            f"{told}; name a file of yours with mode 600", path=str(path)
        ) from None
    except OSError as error:
        raise CredentialsMissingError(
            f"credentials file {path} cannot be opened: {error.strerror}; create it with mode 600",
            path=str(path),
        ) from None


def _parse(path: Path, data: bytes) -> Credentials:
    # No cause is chained and no content quoted: a parser's message shows the line, password included.
    problem = None
    document: object = None
    if len(data) > _MAX_SIZE:
        problem = f"has more than {_MAX_SIZE} bytes"
    else:
        try:
            document = parse(data.decode("utf-8"))
        except ValueError:  # not UTF-8, or not YAML
            problem = "is not YAML in UTF-8"
    if problem is None:
        entries = document if isinstance(document, dict) else {}
        texts = [entries[key] for key in ("user", "password", "pin") if isinstance(entries.get(key), str)]
        named = {"user", "password"} <= set(entries) <= {"user", "password", "pin"}
        if named and len(texts) == len(entries) and all(texts):
            return Credentials(*texts)
        problem = "does not hold exactly the texts 'user' and 'password', and perhaps 'pin' (quote digits)"
    raise CredentialsFormatError(
        f'credentials file {path} {problem}; write two lines, user: "..." and password: "..."', path=str(path)
    )
