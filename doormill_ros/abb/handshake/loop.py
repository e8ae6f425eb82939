"""Drive a handshake from its own thread, so that a slow controller never holds up its user."""

from __future__ import annotations

import contextlib
import threading

from doormill_ros.abb.handshake.sharing import SharedHandshake


class HandshakeLoop:
    """Steps a handshake until told to stop; `submit`, `abort` and `snapshot` are the handshake's own.

    The thread is a daemon: a process that ends without `stop` leaves the signals as they are, which
    `Handshake.on_start` of the next process and the robot program both guard against.
    """

    def __init__(self, handshake: SharedHandshake, idle_wait: float = 0.5, held: bool = False) -> None:
        """Prepare the thread.

        Args:
            handshake: State machine; from `start` to `stop` nobody else may step it.
            idle_wait: Longest pause between two steps [s]; transports return earlier on a change.
            held: Touch nothing before `release`.
        """
        self.handshake = handshake
        self.failure: BaseException | None = None
        self._idle_wait = idle_wait
        self._stop = threading.Event()
        self._released = threading.Event()
        if not held:
            self._released.set()
        self._thread = threading.Thread(target=self._run, name="handshake", daemon=True)

    def start(self) -> None:
        """Clear the controller and begin to step."""
        self._thread.start()

    def stop(self, timeout: float = 10.0) -> None:
        """Stop stepping, lower ready, remove the file and close the transport.

        Args:
            timeout: Limit for the step under way [s].
        """
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(timeout)

    def hold(self) -> None:
        """Give up the file in hand, then leave the controller to somebody else; not even `stop` clears it."""
        self._released.clear()
        self.handshake.wake()

    def release(self) -> None:
        """Clear the controller and go on."""
        self._released.set()

    @property
    def alive(self) -> bool:
        """True while the thread steps; a programming error that ended it is in `failure`."""
        return self._thread.is_alive()

    def __enter__(self) -> HandshakeLoop:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _run(self) -> None:
        touching = False
        try:
            while not self._stop.is_set():
                if not self._released.is_set():
                    if touching:
                        self.handshake.rest("another bridge goes to the controller")
                        touching = False
                    self._released.wait(self._idle_wait)
                elif not touching:
                    touching = True
                    self.handshake.on_start()
                else:
                    self.handshake.wait(self._idle_wait)
                    self.handshake.step()
        except BaseException as error:
            self.failure = error
            raise
        finally:
            with contextlib.suppress(Exception):
                if touching:
                    self.handshake.close()
                else:
                    self.handshake.leave()
