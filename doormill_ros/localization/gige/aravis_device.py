"""A GenICam camera by aravis, triggered by software.

Only what comes whole counts: aravis asks for packets anew where the camera can, and tells which pictures lack some.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.gige.device import Limits
from doormill_ros.localization.gige.errors import CameraAbsent, CameraUnfit, PictureLost
from doormill_ros.localization.gige.library import Aravis
from doormill_ros.units import s_to_us, us_to_s

FORMAT = "Mono8"
BUFFERS = 3
PATIENCE = 1.0  # s beside the exposure until a picture is given up
_EXTRA = 1e-9  # s; limits are compared after a conversion


class AravisDevice:
    """A `CameraDevice`; to be used by one thread."""

    def __init__(self, aravis: Aravis, address: str, size: tuple[int, int], packet: int = 0) -> None:
        """Reach the camera and set it up.

        Args:
            aravis: The library.
            address: IP address or aravis' name of the camera; empty for the first one found.
            size: Width and height [px] of the pictures, from the sensor's upper left corner.
            packet: Size of the packets [bytes]; 0 for the largest that come through.

        Raises:
            CameraAbsent: It is not there, or obeys somebody else.
            CameraUnfit: It has no such size, no grey pictures or no trigger.
        """
        self._aravis = aravis
        self._name = address or "the first one found"
        self._size = size
        self._camera: Any = None
        self._stream: Any = None
        self._answers = True
        try:
            with self._obeying():
                self._open(address, packet)
        except BaseException:
            self.close()
            raise

    def _open(self, address: str, packet: int) -> None:
        names = self._aravis.names
        self._camera = camera = names.Camera.new(address or None)
        self._check(camera)
        with contextlib.suppress(self._aravis.error):  # left running by whoever was here before
            camera.stop_acquisition()
        camera.set_pixel_format_from_string(FORMAT)
        camera.set_region(0, 0, *self._size)
        for available, set_auto in (
            (camera.is_exposure_auto_available, camera.set_exposure_time_auto),
            (camera.is_gain_auto_available, camera.set_gain_auto),
        ):
            if available():
                set_auto(names.Auto.OFF)
        camera.set_acquisition_mode(names.AcquisitionMode.CONTINUOUS)
        camera.set_trigger("Software")
        if camera.is_gv_device():
            if packet:
                camera.gv_set_packet_size(packet)
            else:
                camera.gv_auto_packet_size()
        low, high = camera.get_exposure_time_bounds()
        self.exposures = Limits(us_to_s(low), us_to_s(high))
        self._gains = Limits(*camera.get_gain_bounds()) if camera.is_gain_available() else Limits(0.0, 0.0)
        self._stream = camera.create_stream(None, None)
        if self._stream is None:
            raise CameraAbsent(f"camera {self._name} opens no stream; restart it")
        for _ in range(BUFFERS):
            self._stream.push_buffer(names.Buffer.new_allocate(camera.get_payload()))
        camera.start_acquisition()

    def _check(self, camera: Any) -> None:
        width, height = camera.get_sensor_size()
        formats = camera.dup_available_pixel_formats_as_strings()
        if self._size[0] > width or self._size[1] > height:
            raise CameraUnfit(
                f"camera {self._name} has {width} x {height} px, its calibration is for {self._size[0]} x "
                f"{self._size[1]} px; name the camera file of this camera"
            )
        if FORMAT not in formats:
            raise CameraUnfit(
                f"camera {self._name} sends {', '.join(formats)}, needed is {FORMAT}; use a grey camera"
            )
        if not camera.is_software_trigger_supported():
            raise CameraUnfit(
                f"camera {self._name} has no software trigger; use its other driver or another camera"
            )

    def take(self, exposure: float, gain: float) -> ByteArray:
        """One picture, shape (height, width); see `CameraDevice`."""
        for what, unit, value, limits in (
            ("exposure", "s", exposure, self.exposures),
            ("gain", "dB", gain, self._gains),
        ):
            if not limits.low - _EXTRA <= value <= limits.high + _EXTRA:
                raise CameraUnfit(
                    f"{what} is {value:g} {unit}, camera {self._name} allows {limits.low:g} to {limits.high:g} {unit}; "
                    f"correct the parameter {what}"
                )
        with self._obeying():
            self._camera.set_exposure_time(s_to_us(exposure))
            if self._gains.high > self._gains.low:
                self._camera.set_gain(gain)
            while (late := self._stream.try_pop_buffer()) is not None:
                self._stream.push_buffer(late)
            self._camera.software_trigger()
        buffer = self._stream.timeout_pop_buffer(round(s_to_us(exposure + PATIENCE)))
        if buffer is None:
            raise PictureLost(f"no picture came within {exposure + PATIENCE:.2g} s of its trigger")
        try:
            return self._picture(buffer)
        finally:
            self._stream.push_buffer(buffer)

    def _picture(self, buffer: Any) -> ByteArray:
        status = buffer.get_status()
        if status != self._aravis.names.BufferStatus.SUCCESS:
            raise PictureLost(f"it came with the status {status.value_nick}")
        shape = buffer.get_image_height(), buffer.get_image_width()
        pixels = np.frombuffer(buffer.get_data(), dtype=np.uint8)
        if shape != self._size[::-1] or pixels.size < shape[0] * shape[1]:
            raise PictureLost(f"it has {shape[1]} x {shape[0]} px in {pixels.size} bytes")
        return pixels[: shape[0] * shape[1]].reshape(shape)

    def alive(self) -> bool:
        """See `CameraDevice`; a camera on the network is asked every second by aravis."""
        device = self._camera.get_device()
        return not self._camera.is_gv_device() or bool(device.is_controller())

    def close(self) -> None:
        """See `CameraDevice`."""
        if self._stream is not None and self._answers and self.alive():
            with contextlib.suppress(self._aravis.error):
                self._camera.stop_acquisition()
        # The camera is free for others, and for this program, once nobody refers to it.
        self._stream = None
        self._camera = None

    @contextlib.contextmanager
    def _obeying(self) -> Iterator[None]:
        """Whatever the library says of a request, the camera did not obey."""
        try:
            yield
        except self._aravis.error as error:
            self._answers = False
            said = getattr(error, "message", str(error))
            raise CameraAbsent(
                f"camera {self._name} does not answer or obeys somebody else ({said}); check its cable, power and "
                "address, and that no other program uses it"
            ) from error
