"""A camera whose line may lose pictures and break: pictures are taken again, the camera is reached anew."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.gige.device import CameraDevice, Limits
from doormill_ros.localization.gige.errors import CameraAbsent, PictureLost

TRIES = 10  #: pictures asked for until one comes whole


class CameraLine:
    """Keeps a camera reached; to be used by one thread.

    Attributes:
        lost: Pictures that did not come whole.
        reached: How often the camera was reached.
    """

    def __init__(self, connect: Callable[[], CameraDevice]) -> None:
        """Reach nothing yet.

        Args:
            connect: Reaches the camera, or raises CameraAbsent or CameraUnfit.
        """
        self._connect = connect
        self._device: CameraDevice | None = None
        self.lost = 0
        self.reached = 0

    def take(self, exposure: float, gain: float) -> ByteArray:
        """One whole picture, shape (height, width), exposed for `exposure` [s] with `gain` [dB].

        A camera that is gone is reached anew once. One that sends no whole picture is let go of, so that the next
        call begins with a new connection.

        Raises:
            GigeError: CameraAbsent, CameraUnfit or PictureLost.
        """
        gone = False
        for _ in range(TRIES):
            device = self._reached()
            try:
                return device.take(exposure, gain)
            except PictureLost as error:
                self.lost += 1
                last = error
                if device.alive():
                    continue
                self.close()  # it was restarted, and knows nothing of what it was told
            except CameraAbsent:
                self.close()
                if gone:
                    raise
                gone = True
        self.close()
        raise PictureLost(
            f"none of {TRIES} pictures came whole, the last one: {last.message}; check cable, switch and packet size"
        )

    @property
    def exposures(self) -> Limits:
        """What the camera can be exposed for [s].

        Raises:
            GigeError: CameraAbsent or CameraUnfit.
        """
        return self._reached().exposures

    def watch(self) -> None:
        """Reach the camera where it is not, or no longer; for when no picture is wanted.

        Raises:
            GigeError: CameraAbsent or CameraUnfit.
        """
        if self._device is not None and not self._device.alive():
            self.close()
        self._reached()

    def close(self) -> None:
        """Let go of the camera; the next call reaches it anew."""
        device, self._device = self._device, None
        if device is not None:
            device.close()

    def _reached(self) -> CameraDevice:
        if self._device is None:
            self._device = self._connect()
            self.reached += 1
        return self._device
