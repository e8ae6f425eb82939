"""What a camera on the network can be asked for; whoever asks knows no library."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from doormill_ros.arrays import ByteArray


class Limits(NamedTuple):
    """The least and the most that a camera can be set to."""

    low: float
    high: float


class CameraDevice(Protocol):
    """A camera that was reached."""

    exposures: Limits  #: [s]

    def take(self, exposure: float, gain: float) -> ByteArray:
        """One picture, shape (height, width), exposed for `exposure` [s] with `gain` [dB].

        Raises:
            PictureLost: It did not come whole; another one may.
            CameraAbsent: The camera does not answer, or obeys somebody else.
            CameraUnfit: It cannot be exposed so.
        """

    def alive(self) -> bool:
        """Whether the camera still answers and obeys."""

    def close(self) -> None:
        """Let go of it; whatever the line does."""
