"""Message definitions and their hashes, as the interface packages install them."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from doormill_ros.recording.errors import UnknownTypeError

SEPARATOR = "=" * 80
PRIMITIVES = {
    "bool", "byte", "char", "float32", "float64", "int8", "uint8", "int16", "uint16",
    "int32", "uint32", "int64", "uint64", "string", "wstring",
}  # fmt: skip
#: What an action publishes while it works on a goal; no .msg file holds its definition.
FEEDBACK = re.compile(r"(\w+)/action/(\w+)_FeedbackMessage")
IDENTIFIER = "unique_identifier_msgs/UUID"
#: Messages of our own that stand for those of a package that the wheels lack, and are recorded as those.
STANDS_FOR = {"doormill_interfaces/msg/TFMessage": "tf2_msgs/msg/TFMessage"}
STAND_INS = {theirs: ours for ours, theirs in STANDS_FOR.items()}
FIELD = re.compile(r"^\s*([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w+")


@dataclass(frozen=True)
class Schema:
    """A message type as it travels in a bag.

    Attributes:
        name: Full type name, for example "std_msgs/msg/Bool".
        text: Its definition followed by those of every type it uses (encoding "ros2msg").
        type_hash: RIHS01 hash of the type description (REP 2016).
    """

    name: str
    text: str
    type_hash: str


def _share_file(name: str, suffix: str) -> Path:
    package, kind, message = name.split("/")
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix) / "share" / package / kind / f"{message}{suffix}"
        if prefix and path.is_file():
            return path
    raise UnknownTypeError(
        f"message type {name} has no {suffix} file in AMENT_PREFIX_PATH; install or source its package",
        type=name,
    )


def _used_types(text: str, package: str) -> list[str]:
    """Full names of the message types that a definition uses, in order of appearance."""
    used = []
    for line in text.splitlines():
        match = FIELD.match(line.split("#")[0])
        if not match or match[1] in PRIMITIVES:
            continue
        parts = match[1].split("/")
        name = f"{package}/msg/{parts[0]}" if len(parts) == 1 else f"{parts[0]}/msg/{parts[-1]}"
        if name not in used:
            used.append(name)
    return used


def _part(title: str, text: str) -> str:
    return f"{SEPARATOR}\nMSG: {title}\n{text}"


def _message(name: str) -> tuple[list[str], list[str]]:
    """Definition of a message, and the types it uses."""
    text = _share_file(name, ".msg").read_text(encoding="utf-8")
    return [text], _used_types(text, name.split("/")[0])


def _feedback_message(package: str, action: str) -> tuple[list[str], list[str]]:
    """Definitions of what an action publishes as feedback and of the feedback in it, and the types they use."""
    text = _share_file(f"{package}/action/{action}", ".action").read_text(encoding="utf-8")
    _, _, feedback = re.split(r"^---\s*$", text, flags=re.MULTILINE)
    whole = f"{IDENTIFIER} goal_id\n{action}_Feedback feedback\n"
    # Messages go by two parts of their name in definitions; an action's type keeps the one between.
    inner = _part(f"{package}/action/{action}_Feedback", feedback.lstrip("\n"))
    return [whole, inner], _used_types(f"{IDENTIFIER} goal_id\n{feedback}", package)


@cache
def load_schema(name: str) -> Schema:
    """Definition and hash of a message type, from the ament index; that of another type which it stands for.

    Raises:
        UnknownTypeError: The type's package is not installed, nor a message that stands for it.
    """
    if name in STAND_INS:
        try:
            _share_file(name, ".msg")
        except UnknownTypeError:
            return load_schema(STAND_INS[name])
    feedback = FEEDBACK.fullmatch(name)
    parts, pending = _feedback_message(*feedback.groups()) if feedback else _message(name)
    seen = {name}
    while pending:
        used = pending.pop(0)
        if used in seen:
            continue
        seen.add(used)
        (used_text,), further = _message(used)
        package, _, message = used.split("/")
        parts.append(_part(f"{package}/{message}", used_text))
        pending.extend(further)
    text = "\n".join(parts)
    if name in STANDS_FOR:
        return Schema(STANDS_FOR[name], text, _hash(STANDS_FOR[name], text))
    described = f"{feedback[1]}/action/{feedback[2]}" if feedback else name
    description = json.loads(_share_file(described, ".json").read_text(encoding="utf-8"))
    type_hash = next(e["hash_string"] for e in description["type_hashes"] if e["type_name"] == name)
    return Schema(name, text, type_hash)


def _hash(name: str, text: str) -> str:
    """RIHS01 hash of a type that is not installed, from its definition."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, name))
    return str(store.hash_rihs01(name))
