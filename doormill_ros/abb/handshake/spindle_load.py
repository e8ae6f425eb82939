"""What the spindle's drive gives while a door is milled, asked for at any time and told of milling alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from doormill_ros.abb import signals
from doormill_ros.abb.analog_inputs import AnalogInputs
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import UnknownSignalError
from doormill_ros.abb.transport import Transport

_PERCENT = 0.01


@dataclass(frozen=True)
class LoadSample:
    """One look at the spindle's load.

    Attributes:
        run_id: The run that is being milled.
        load: Share of the drive's nominal power.
    """

    run_id: str
    load: float


class SpindleLoadMeter:
    """Reads the load of the run in hand; a controller that has no such signal is not asked again.

    Attributes:
        able: Whether there is anything to ask.
    """

    def __init__(self, transport: Transport, snapshot: Callable[[], HandshakeSnapshot]) -> None:
        """Ask nothing yet.

        Args:
            transport: Way to the controller; one that cannot read analog signals is never asked.
            snapshot: Gives the handshake as it is now.
        """
        self._inputs = transport if isinstance(transport, AnalogInputs) else None
        self._snapshot = snapshot

    @property
    def able(self) -> bool:
        """Whether there is anything to ask."""
        return self._inputs is not None

    def sample(self) -> LoadSample | None:
        """The load now; None unless one run is milled before and after the look.

        Raises:
            UnknownSignalError: The controller has no such signal, told once.
            LinkError: It cannot be read now.
        """
        before = self._snapshot()
        if self._inputs is None or before.state is not HandshakeState.MILLING:
            return None
        try:
            percent = self._inputs.read_analog(signals.SPINDLE_LOAD)
        except UnknownSignalError:
            self._inputs = None
            raise
        after = self._snapshot()
        if after.state is not HandshakeState.MILLING or after.run_id != before.run_id:
            return None
        return LoadSample(before.run_id, percent * _PERCENT)
