"""Where signals lie on the controller, for those whose plain name does not do: network, device and name."""

from __future__ import annotations

import re

from doormill_ros.abb import signals
from doormill_ros.cell.errors import BadParameterError

PARAMETER = "signal_paths"  #: of the bridge
_PART = re.compile(r"[A-Za-z]\w*")  # an identifier of RAPID
_NAMES = frozenset((*signals.ALL_SIGNALS, *signals.GROUP_SIGNALS, signals.SPINDLE_LOAD))


def signal_paths(text: str) -> dict[str, str]:
    """Paths by the name of the signal.

    Args:
        text: `NETWORK/DEVICE/NAME` of any number of signals, separated by spaces.

    Raises:
        BadParameterError: One is not of that form, names a signal that the bridge does not use, or one twice.
    """
    paths: dict[str, str] = {}
    for path in text.split():
        parts = path.split("/")
        if len(parts) != 3 or not all(_PART.fullmatch(part) for part in parts):
            raise BadParameterError(
                f"parameter {PARAMETER} has {path!r}, allowed is NETWORK/DEVICE/NAME as in the controller's I/O "
                "configuration; correct it"
            )
        name = parts[-1]
        if name not in _NAMES or name in paths:
            raise BadParameterError(
                f"parameter {PARAMETER} names {name} {'twice' if name in paths else 'in ' + repr(path)}, allowed is "
                f"each of {', '.join(sorted(_NAMES))} once; correct it"
            )
        paths[name] = path
    return paths
