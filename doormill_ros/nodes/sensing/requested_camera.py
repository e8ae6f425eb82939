"""A camera that the controller's request triggers: a picture for each run, sent until it was used."""

from __future__ import annotations

from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_ros.frames import CAMERA_FRAME
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.sensing.requested_sensor import RequestedSensor


class RequestedCamera(RequestedSensor):
    """Sends pictures while the request is high; subclasses say which (`picture`) and of what camera."""

    def open_camera(self, retry_period: float) -> None:
        """Publish and subscribe; a picture that nobody used is sent again after `retry_period` [s]."""
        self._image = self.publisher(topics.IMAGE)
        self._info = self.publisher(topics.CAMERA_INFO)
        self.open_sensor(retry_period)

    def start(self) -> None:
        """Tell the intrinsics once; they go out with every picture too."""
        self._info.publish(self.camera_info(self._header()))

    def picture(self, run_id: str) -> Image | None:
        """What the camera sees in that run; None when it sees nothing."""
        raise NotImplementedError

    def camera_info(self, header: Header) -> CameraInfo:
        """Of the camera, with the header of the picture."""
        raise NotImplementedError

    def send(self, run_id: str) -> None:
        """Send that run's picture, if there is one."""
        picture = self.picture(run_id)
        if picture is None:
            return
        header = self._header()
        self._info.publish(self.camera_info(header))
        picture.header = header
        self._image.publish(picture)

    def _header(self) -> Header:
        return Header(stamp=self.get_clock().now().to_msg(), frame_id=CAMERA_FRAME)
