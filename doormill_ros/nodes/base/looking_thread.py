"""Part of /abb_bridge: a thread that looks at something until it is told to cease."""

from __future__ import annotations

import threading
from collections.abc import Callable

STOP_LIMIT = 5.0  # s


class LookingThread:
    """A thread of its own for what waits for the controller.

    Args:
        look: Called once; returns soon after the event that it is given was set.
        name: Of the thread.
    """

    def __init__(self, look: Callable[[threading.Event], None], name: str) -> None:
        self._ended = threading.Event()
        self._thread = threading.Thread(target=look, args=(self._ended,), name=name, daemon=True)

    def start(self) -> None:
        """Begin to look."""
        self._thread.start()

    def stop(self) -> None:
        """Cease to look; a thread that never began is none to wait for."""
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)
