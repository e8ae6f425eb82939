"""What two values that were read have to have in common to be the same."""

from __future__ import annotations

import enum
import re
from collections.abc import Iterator, Mapping, Set
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.trial_table import TrialTable

#: Kept for complaints about a line; lines are what a rewritten file may change.
_TEXTS = (SetDocument, TrialTable)
_LINES = {"line", "lines"}
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")
#: Values in one that is compared: what references in a text multiply ends here, not when the memory does.
MOST = 300_000
_WHOLE = 2**53  # up to here a float is the same number


def essence(value: Any) -> Any:
    """A value as nested tuples that compare equal where the values mean the same; NaN equals NaN.

    Raises:
        ValueError: It has more than `MOST` values.
    """
    return _essence(value, iter(range(MOST)))


def _essence(value: Any, left: Iterator[int]) -> Any:
    if next(left, None) is None:
        raise ValueError(f"more than {MOST} values")
    if value is None or isinstance(value, bool | str | bytes):
        return value if not isinstance(value, enum.Enum) else value.name
    if isinstance(value, enum.Enum):
        return value.name
    if isinstance(value, int | float | np.number):
        return repr(float(value)) if abs(value) < _WHOLE or value != value else repr(value)
    if isinstance(value, np.ndarray):
        numbers = value.astype(float) if value.dtype.kind in "iuf" else value
        return value.shape, numbers.tobytes()
    if isinstance(value, Mapping):
        return tuple(
            sorted(
                ((repr(_essence(k, left)), _essence(v, left)) for k, v in value.items()), key=lambda p: p[0]
            )
        )
    if isinstance(value, Set):
        return tuple(sorted(repr(_essence(item, left)) for item in value))
    if isinstance(value, list | tuple):
        return tuple(_essence(item, left) for item in value)
    if isinstance(value, (*_TEXTS, type, Path)):
        return str(value) if isinstance(value, Path) else type(value).__name__
    names = {*getattr(value, "__dict__", ()), *getattr(type(value), "__slots__", ())} - _LINES
    if callable(value) or not names:
        return _ADDRESS.sub("", repr(value))
    return type(value).__name__, tuple(
        (name, _essence(getattr(value, name, None), left)) for name in sorted(names)
    )


def difference(first: Any, second: Any) -> str:
    """The first place where two essences differ, cut to a line; empty where they do not."""
    if first == second:
        return ""
    if isinstance(first, tuple) and isinstance(second, tuple) and len(first) == len(second):
        for one, other in zip(first, second, strict=True):
            if one != other:
                return difference(one, other)
    return f"{first!r:.100} became {second!r:.100}"
