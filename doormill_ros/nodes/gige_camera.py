"""Node /gige_camera: a GenICam camera by aravis, triggered for each run; its line may break and come back."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import Any

from rclpy.logging import get_logger
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorLocalization, DoorRecipe
from doormill_ros.cell.graph.node_names import GIGE_CAMERA
from doormill_ros.cell.places.layout import CAMERA, load_layout
from doormill_ros.frames import BASE_FRAME
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.gige.aravis_device import AravisDevice
from doormill_ros.localization.gige.device import Limits
from doormill_ros.localization.gige.errors import AravisMissing, GigeError, NoPictureInTime
from doormill_ros.localization.gige.exposure import EdgeLight, Exposed, exposed
from doormill_ros.localization.gige.library import Aravis, load_aravis
from doormill_ros.localization.gige.line import CameraLine
from doormill_ros.localization.gige.waiting import Waiting
from doormill_ros.localization.view import face_view
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.convert.picture import camera_info_message, picture_message
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.sensing.pose_teller import PoseTeller
from doormill_ros.nodes.sensing.requested_camera import RequestedCamera
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER

WATCH_PERIOD = 2.0  # s between looks at a camera of which no picture is wanted
LOOK_PERIOD = 0.1  # s between looks at how long a run has waited for its picture
LAST_CALL = 3.0  # s that the end waits for the camera; the library may wait longer for one that is gone
UNUSABLE = 2  #: exit status after which nobody starts the node again


class GigeCamera(RequestedCamera):
    """Lets a thread of its own wait for the camera: one that is gone is waited for by the library for seconds."""

    PARAMETERS = (
        NodeParameter(
            "address", "", "IP address of the camera, or its name as arv-tool-0.8 lists it; empty: the first"
        ),
        NodeParameter("camera", "", "camera file of this camera; empty: config/camera.yaml"),
        NodeParameter("packet_size", 0, "bytes of a packet; 0: the largest that come through", 0, 65_000),
        NodeParameter(
            "exposure", 0.01, "[s]; with exposure_auto the one to begin with", 1e-5, 10.0, live=True
        ),
        NodeParameter("gain", 0.0, "[dB]", 0.0, 60.0, live=True),
        NodeParameter("exposure_auto", True, "expose by the light at the door's edges", live=True),
        NodeParameter("exposure_longest", 0.1, "longest automatic exposure [s]", 1e-5, 10.0, live=True),
        NodeParameter(
            "retry_period", 1.0, "a picture that nobody used is taken again after [s]", 0.1, 3600.0
        ),
        NodeParameter(
            "limit",
            8.0,
            "a door of which no picture came is refused after [s]; below limit.picture of /abb_bridge",
            0.1,
            600.0,
            live=True,
        ),
        SENSORS_PARAMETER,
    )

    def __init__(self, aravis: Aravis | None = None, **kwargs: Any) -> None:
        """Take the parameters and load the library, unless it is given.

        Raises:
            AravisMissing: It is not there.
        """
        super().__init__(GIGE_CAMERA, **kwargs)
        try:
            self._aravis = aravis or load_aravis()
        except AravisMissing:
            self.destroy_node()
            raise

    def setup(self) -> None:
        """Read the camera file; subscribe. The camera itself is reached by the thread, whenever it is there."""
        self._model = load_camera(Path(self.value("camera")) if self.value("camera") else None)
        self._layout = load_layout()
        self._light: EdgeLight | None = None
        self._exposed = 0.0
        self._thread: threading.Thread | None = None
        self._recipe: DoorRecipe | None = None
        self._waiting = Waiting()
        self._teller = PoseTeller(self, CAMERA, self._layout)
        self.open_camera(self.value("retry_period"))
        self.every(LOOK_PERIOD, self._give_up_waiting)
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)

    def start(self) -> None:
        """Begin to reach the camera."""
        super().start()
        self._asked, self._wake, self._over = "", threading.Event(), threading.Event()
        address, packet = self.value("address"), self.value("packet_size")
        self._line = CameraLine(lambda: AravisDevice(self._aravis, address, self._model.size, packet))
        self._thread = threading.Thread(
            target=self._work, args=(self._line, self._wake, self._over), name="camera", daemon=True
        )
        self._thread.start()

    def stop(self) -> None:
        """Let go of the camera."""
        if self._thread is None:
            return
        self._over.set()
        self._wake.set()
        self._thread.join(LAST_CALL)
        self._thread = None

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        if self.is_new(recipe.run_id):
            view = face_view(self._model, self._layout, recipe.width, recipe.thickness)
            self._light, self._recipe = EdgeLight(view, self._layout.limits), recipe
            self.want(recipe.run_id)

    def _give_up_waiting(self) -> None:
        """Answer a run whose picture does not come: the library may wait for the camera longer than the bridge."""
        recipe = self._recipe
        run_id = recipe.run_id if recipe is not None and self.still_wanted(recipe.run_id) else ""
        waited = self._waiting.of(run_id, time.monotonic())
        if recipe is None or waited < self.value("limit"):
            return
        self.unwant(run_id)
        reason = NoPictureInTime(
            f"no picture of the door came within {waited:.1f} s: {self._waiting.reason}", run_id=run_id
        )
        answer = DoorLocalization(run_id=run_id, door_id=recipe.door_id, error_code=reason.code)
        answer.header = Header(stamp=self.get_clock().now().to_msg(), frame_id=BASE_FRAME)
        answer.reason, answer.duration = reason.message, waited
        self._teller.refuse(answer)
        self.get_logger().error(f"door {recipe.door_id}: {reason.message}")

    def send(self, run_id: str) -> None:
        """Have the thread take and send that run's picture."""
        self._asked = run_id
        self._wake.set()

    def _work(self, line: CameraLine, wake: threading.Event, over: threading.Event) -> None:
        """Take what is asked for; else look whether the camera is there."""
        well = False
        while not over.is_set():
            wake.clear()
            run_id, self._asked = self._asked, ""
            well = self._sent(run_id) if run_id else self._watched(well)
            wake.wait(WATCH_PERIOD)
        line.close()

    def _sent(self, run_id: str) -> bool:
        def take() -> None:
            try:
                super(GigeCamera, self).send(run_id)
            except GigeError as error:
                self._waiting.failed(error.message)
                raise
            self._waiting.taken(run_id)

        return self.attempt("take a picture", take)

    def _watched(self, well: bool) -> bool:
        before = self._line.reached
        if not self.attempt("reach the camera", self._line.watch):
            return False
        if not well or self._line.reached != before:
            self.report(OK, "the camera answers", reached=self._line.reached, lost=self._line.lost)
        return True

    def picture(self, run_id: str) -> Image | None:
        """A new one; None if that run no longer wants it."""
        taken = self._taken()
        if not self.still_wanted(run_id):
            return None
        self.report(
            OK,
            "picture taken",
            exposure=f"{taken.exposure:.6f}",
            light=f"{taken.level:.0f}",
            lost=self._line.lost,
            reached=self._line.reached,
        )
        return picture_message(taken.picture, Header())

    def _taken(self) -> Exposed:
        gain, light = self.value("gain"), self._light
        first = self.value("exposure")
        if light is None or not self.value("exposure_auto"):
            picture = self._line.take(first, gain)
            return Exposed(picture, first, light.level(picture) if light else 0.0)
        low, high = self._line.exposures
        limits = Limits(low, max(low, min(high, self.value("exposure_longest"))))
        taken = exposed(lambda s: self._line.take(s, gain), light, self._exposed or first, limits)
        self._exposed = taken.exposure
        return taken

    def camera_info(self, header: Header) -> CameraInfo:
        """That of the camera file."""
        return camera_info_message(self._model.k, self._model.distortion, self._model.size, header)


def main() -> int:
    """Run the node; without the library say so."""
    try:
        return run_nodes(GigeCamera)
    except AravisMissing as error:
        get_logger("doormill").fatal(error.message)
        return UNUSABLE


if __name__ == "__main__":
    sys.exit(main())
