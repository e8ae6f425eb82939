"""What outputs do when the controller loses its power and when it is back.

Without power every output is low. A controller that is back gives an output of `-SafeLevel "SafetySafeLevel"` its
default value, and any other one the value it had, as `DefaultSafeLevel` does [?]: the stricter of two readings, for
a public page (industrialmonitordirect.com, "Configuring ABB IRC5 DO signal safe level") has all of them at default.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable


class OutputMemory:
    """The outputs of a controller through a loss of power.

    Args:
        outputs: Names of all digital and analog outputs.
        safe: Those that return to their default value.
        read: Gives an output's value.
        write: Sets one, whatever its access level.
    """

    def __init__(
        self,
        outputs: Iterable[str],
        safe: frozenset[str],
        read: Callable[[str], float],
        write: Callable[[str, float], None],
    ) -> None:
        self._outputs, self._safe, self._read, self._write = tuple(outputs), safe, read, write
        self._kept: dict[str, float] | None = None

    @property
    def dropped(self) -> bool:
        """Whether the outputs are without power."""
        return self._kept is not None

    def drop(self) -> None:
        """Lose the power."""
        if self._kept is None:
            self._kept = {name: self._read(name) for name in self._outputs}
            for name in self._outputs:
                self._write(name, 0.0)

    def come_back(self) -> None:
        """Have the power back, or restart."""
        kept = self._kept if self._kept is not None else {name: self._read(name) for name in self._outputs}
        self._kept = None
        for name, value in kept.items():
            self._write(name, 0.0 if name in self._safe else value)
