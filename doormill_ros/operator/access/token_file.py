"""The file that holds the tokens of the roles, for a page that starts by itself."""

from __future__ import annotations

import os
import re
from pathlib import Path

from doormill_ros.files import NotPrivateError, read_private
from doormill_ros.operator.access.token import Holder, Keys, Role, new_token
from doormill_ros.operator.errors import TokenFileError
from doormill_ros.yaml_text import parse

_MOST = 10_000  # bytes
_ROLES = (Role.OPERATE.word, Role.ENGINEER.word)
#: What a browser can send and nobody guesses.
_TOKEN = re.compile(r"[A-Za-z0-9_-]{16,100}")
_LONGEST_NAME = 40  # characters


def load_keys(path: Path) -> Keys:
    """The tokens of a file; where there is no file it is made, with a new token for each role.

    Args:
        path: YAML with `operate:` or `engineer:` or both, mode 600; each a token, or tokens by people's names.

    Raises:
        TokenFileError: It cannot be read or made, others may read it, or it is not as described.
    """
    try:
        _make(path)
        data = read_private(path, _MOST + 1)
    except NotPrivateError as error:
        cure = (
            "others may have read the tokens: remove it, and the page makes it anew with tokens nobody knows"
            if error.mode
            else "name a file of the user that the page runs as"
        )
        raise TokenFileError(f"the file of tokens {path} {error}; {cure}", path=str(path)) from None
    except OSError as error:
        raise TokenFileError(
            f"the file of tokens {path} can be neither read nor made: {error.strerror}; make its folder one that the "
            "page may write, or name another with the parameter tokens of /operator_page",
            path=str(path),
        ) from None
    return _keys(path, data)


def _make(path: Path) -> None:
    text = "".join(f"{role}: {new_token()}\n" for role in _ROLES)
    try:
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600)
    except FileExistsError:
        return
    with os.fdopen(file, "w") as stream:
        stream.write(text)


def _keys(path: Path, data: bytes) -> Keys:
    # No content is quoted and no cause chained: a parser's message shows the line, token included.
    document: object = None
    if len(data) <= _MOST:
        try:
            document = parse(data.decode("utf-8"))
        except ValueError:  # not UTF-8, or not YAML
            document = None
    entries = document if isinstance(document, dict) else {}
    people = {
        Holder(Role[role.upper()], name): token
        for role, named in entries.items()
        if role in _ROLES and isinstance(named, dict) and all(map(_is_name, named))
        for name, token in named.items()
    }
    shared = {role: token for role, token in entries.items() if isinstance(token, str)}
    tokens = [*shared.values(), *people.values()]
    good = {token for token in tokens if isinstance(token, str) and _TOKEN.fullmatch(token)}
    known = {*shared, *(holder.role.word for holder in people)}
    if not entries or set(entries) != known or not known <= set(_ROLES) or len(good) < len(tokens):
        raise TokenFileError(
            f"the file of tokens {path} does not hold a line for one or both of the roles {' and '.join(_ROLES)}, each "
            "with a token of its own of 16 to 100 letters, digits, - and _ (quote digits), or with names of people of "
            f"at most {_LONGEST_NAME} characters and a token for each; remove it, and the page makes it anew",
            path=str(path),
        )
    return Keys(shared.get(_ROLES[0]), shared.get(_ROLES[1]), people)


def _is_name(name: object) -> bool:
    return (
        isinstance(name, str) and name.isprintable() and 0 < len(name.strip()) <= len(name) <= _LONGEST_NAME
    )
