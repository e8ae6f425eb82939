"""A camera that the controller's request triggers: a picture for each run, sent until it was used."""

from __future__ import annotations

import threading

from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Bool, Header

from doormill_interfaces.msg import RunResult
from doormill_ros.frames import CAMERA_FRAME
from doormill_ros.nodes import topics
from doormill_ros.nodes.managed_node import ManagedNode


class RequestedCamera(ManagedNode):
    """Sends pictures while the request is high; subclasses say which (`picture`) and of what camera."""

    def open_camera(self, retry_period: float) -> None:
        """Publish and subscribe; a picture that nobody used is sent again after `retry_period` [s]."""
        self._run_id = ""
        self._wanted = self._request = False
        self._lock = threading.Lock()
        self._image = self.publisher(topics.IMAGE)
        self._info = self.publisher(topics.CAMERA_INFO)
        self.subscribe(topics.ABB_REQUEST, self._take_request)
        self.subscribe(topics.ABB_READY, self._take_ready)
        self.subscribe(topics.RUN_RESULT, self._take_result)
        self.every(retry_period, self.expose)

    def start(self) -> None:
        """Tell the intrinsics once; they go out with every picture too."""
        self._info.publish(self.camera_info(self._header()))

    def picture(self, run_id: str) -> Image | None:
        """What the camera sees in that run; None when it sees nothing."""
        raise NotImplementedError

    def camera_info(self, header: Header) -> CameraInfo:
        """Of the camera, with the header of the picture."""
        raise NotImplementedError

    def is_new(self, run_id: str) -> bool:
        """Whether no picture of that run was wanted before."""
        return run_id != self._run_id

    def want(self, run_id: str) -> None:
        """A door stands; from now on pictures of it are sent when they are asked for."""
        with self._lock:
            self._run_id, self._wanted = run_id, True
        self.expose()

    def expose(self) -> None:
        """Take the picture once door and request are there; again until the targets are ready."""
        with self._lock:
            run_id, wanted = self._run_id, self._wanted
        picture = self.picture(run_id) if wanted and self._request else None
        if picture is None:
            return
        header = self._header()
        self._info.publish(self.camera_info(header))
        picture.header = header
        self._image.publish(picture)

    def _header(self) -> Header:
        return Header(stamp=self.get_clock().now().to_msg(), frame_id=CAMERA_FRAME)

    def _take_request(self, request: Bool) -> None:
        rose = request.data and not self._request
        self._request = request.data
        if rose:
            self.expose()

    def _take_ready(self, ready: Bool) -> None:
        if ready.data:
            self._forget()

    def _take_result(self, result: RunResult) -> None:
        if result.run_id == self._run_id:
            self._forget()

    def _forget(self) -> None:
        with self._lock:
            self._wanted = False
