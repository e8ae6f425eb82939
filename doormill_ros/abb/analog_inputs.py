"""Analog signals of a controller: what a transport needs that can read them, and how they are written."""

from __future__ import annotations

import math
import re
from typing import Protocol, runtime_checkable

_DECIMAL = re.compile(r"[+-]?\d{1,15}(?:\.\d{0,15})?(?:[eE][+-]?\d{1,2})?")


@runtime_checkable
class AnalogInputs(Protocol):
    """A transport that can also read analog signals; the handshake needs none."""

    def read_analog(self, name: str) -> float:
        """An analog signal as the controller has it, in the unit of its configuration.

        Raises:
            UnknownSignalError: The controller has no such signal.
            LinkError: The signal cannot be read.
        """
        ...


def decimal(text: str) -> float | None:
    """The number in an answer; None for what is none, or not finite."""
    value = float(text) if _DECIMAL.fullmatch(text.strip()) and text.isascii() else math.nan
    return value if math.isfinite(value) else None
