"""The operator's view as it stands, kept for whoever reads or changes it."""

from __future__ import annotations

import threading
from collections.abc import Callable

from doormill_ros.operator.views.state import CellView


class ViewStore:
    """The current view; changed and read from any thread."""

    def __init__(self, view: CellView | None = None) -> None:
        """Begin with an empty view."""
        self._view = view or CellView()
        self._lock = threading.Lock()
        self._listeners: list[Callable[[], None]] = []

    @property
    def view(self) -> CellView:
        """The view of this moment."""
        return self._view

    def update(self, change: Callable[[CellView], CellView]) -> None:
        """Replace the view by what `change` makes of it, and tell who listens if it differs."""
        with self._lock:
            changed = change(self._view)
            if changed == self._view:
                return
            self._view = changed
            listeners = tuple(self._listeners)
        for listener in listeners:
            listener()

    def listen(self, listener: Callable[[], None]) -> Callable[[], None]:
        """Call `listener` after every change; returns what ends that."""
        with self._lock:
            self._listeners.append(listener)

        def end() -> None:
            with self._lock:
                if listener in self._listeners:
                    self._listeners.remove(listener)

        return end
