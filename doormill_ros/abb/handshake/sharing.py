"""A handshake that leaves the controller to another bridge for a while, or for good."""

from __future__ import annotations

from doormill_ros.abb import link_errors
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState as State


class SharedHandshake(Handshake):
    """`rest` and `leave` come from the stepping thread, `wake` from any."""

    def wake(self) -> None:
        """End a `wait`; from any thread."""
        self._transport.wake()

    def rest(self, reason: str) -> None:
        """Give up the file in hand and take no notice of the controller any more until `on_start`."""
        if self._snapshot.state is State.READY:
            self._fail(link_errors.RunAbortedError(reason))
        if self._snapshot.state is State.MILLING:
            # Nobody here will see its end; a start that finds the robot busy yet takes the run up again.
            told = f"{reason}, and the robot may be milling yet: look at the robot before you repeat"
            self._runs.end_milling(self._snapshot.run_id, False, told)
        self._drop_submission(link_errors.RunAbortedError(reason))
        self._enter(State.IDLE, reason, 0, request=False)

    def leave(self) -> None:
        """Close the transport and leave the controller as it is: another one's file may stand there."""
        self._transport.close()
