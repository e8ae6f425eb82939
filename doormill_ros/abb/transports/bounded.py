"""Run calls that may hang (a dead network, a disk that does not answer) one after the other, each with a time limit."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class CallTimeout(Exception):
    """The call did not return in time; it may still take effect."""


class _Call(Generic[T]):
    """One call on its way to the worker and back."""

    def __init__(self, function: Callable[[], T]) -> None:
        self._function = function
        self.started = False
        self.given_up = False
        self.done = threading.Event()
        self._results: list[T] = []
        self._error: BaseException | None = None

    def make(self) -> None:
        """Call the function, on the worker."""
        try:
            self._results.append(self._function())
        except BaseException as error:
            self._error = error
        self.done.set()

    def result(self) -> T:
        """What the function returned or raised, once done."""
        if self._error is not None:
            raise self._error
        return self._results[0]


class BoundedCaller:
    """A daemon thread that makes calls in order.

    One thread, not a pool: a call that hangs keeps the later ones from overtaking it, so a late
    "ready high" can never follow a "ready low" that was ordered after it.
    """

    def __init__(self, name: str) -> None:
        """Start the thread.

        Args:
            name: Thread name.
        """
        self._queue: queue.SimpleQueue[_Call[Any] | None] = queue.SimpleQueue()
        self._stuck: _Call[Any] | None = None
        self._closed = False
        self._mutex = threading.Lock()
        self._thread = threading.Thread(target=self._work, name=name, daemon=True)
        self._thread.start()

    def call(self, function: Callable[[], T], timeout: float) -> T:
        """The function's result, or its exception.

        Args:
            function: What to do.
            timeout: Limit [s].

        Raises:
            CallTimeout: Not done in time, or an earlier call still hangs (then this one is not made).
        """
        if self._closed:
            raise CallTimeout
        if self._stuck is not None:
            if not self._stuck.done.wait(timeout):
                raise CallTimeout
            self._stuck = None
        call = _Call(function)
        self._queue.put(call)
        if not call.done.wait(timeout):
            with self._mutex:
                call.given_up = True
                if call.started:
                    self._stuck = call
            raise CallTimeout
        return call.result()

    def close(self) -> None:
        """Let the thread end when its last call returns; does not wait. Later calls are refused."""
        self._closed = True
        self._queue.put(None)

    def _work(self) -> None:
        while (call := self._queue.get()) is not None:
            with self._mutex:
                # What waited behind a hanging call until its caller gave it up must not happen any more.
                call.started = not call.given_up
            if call.started:
                call.make()
