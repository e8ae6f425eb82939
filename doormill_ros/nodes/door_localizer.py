"""Node /door_localizer: pictures in, the door's pose out, or the reason why there is none."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, TypeAlias

import cv2
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorLocalization, DoorRecipe
from doormill_ros.arrays import ByteArray
from doormill_ros.cell.graph.node_names import DOOR_LOCALIZER
from doormill_ros.cell.places.layout import CAMERA, load_layout
from doormill_ros.errors import DoormillError
from doormill_ros.frames import BASE_FRAME, CAMERA_FRAME, DOOR_FRAME
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.empty_clamp.empty_clamp import empty_clamp_for, widths_told
from doormill_ros.localization.errors import LocalizationError, StaleEmptyClamp
from doormill_ros.localization.localizer import prepare
from doormill_ros.localization.marks.drift import Drift
from doormill_ros.localization.marks.mark_watch import MarkWatch
from doormill_ros.localization.overlay import draw_overlay, draw_refusal
from doormill_ros.localization.rehearsal import FACE, drawn_door
from doormill_ros.localization.result import Localization
from doormill_ros.messages.camera_info import camera_of
from doormill_ros.messages.picture import picture_of
from doormill_ros.messages.stamps import nanoseconds_of, seconds_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.frame_publisher import FramePublisher
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.sensing.pose_teller import PoseTeller
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.pipeline.look import look
from doormill_ros.robot.urdf import LinkPose
from doormill_ros.units import ns_to_s

LOOK_PERIOD = 0.25  # s between looks at how long a picture has waited for its camera_info

Picture: TypeAlias = Image | CompressedImage


class DoorLocalizer(ManagedNode):
    """Localizes the door of the recipe in hand in every picture that arrives."""

    PARAMETERS = (
        NodeParameter(
            "check_age", True, "refuse pictures that are too old; false when a bag is replayed", live=True
        ),
        NodeParameter(
            "camera_info_wait",
            3.0,
            "how long a picture waits for the first camera info [s]",
            0.0,
            30.0,
            live=True,
        ),
        NodeParameter(
            "overlay_step", 2, "the overlay shows every n-th pixel; 0: no overlay", 0, 8, live=True
        ),
        SENSORS_PARAMETER,
        NodeParameter("frames", True, "publish the frames of camera and door"),
        NodeParameter("empty_clamp", True, "hold doors against camera.yaml's pictures of the empty clamp"),
        NodeParameter("image_transport", "raw", "how pictures come", choices=tuple(topics.PICTURES)),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(DOOR_LOCALIZER, **kwargs)

    def setup(self) -> None:
        """Load camera mounting and cell layout; subscribe.

        Raises:
            BadParameterError: The list of sensors is none.
            BadSensorFile: The list names one that does not exist.
        """
        self._layout = load_layout()
        self._mounted = load_camera()
        if not self.value("empty_clamp"):
            self._mounted = replace(self._mounted, empty=())
        self._camera: CameraModel | None = None
        self._unusable: LocalizationError | None = None  # why the latest camera info is
        self._intrinsics: tuple[Any, ...] = ()
        self._recipe: DoorRecipe | None = None
        self._waiting: tuple[Picture, float] | None = None
        self._teller = PoseTeller(self, CAMERA, self._layout)
        self._marks = MarkWatch()
        self._moved = self.publisher(topics.CAMERA_MOVED) if self._mounted.marks is not None else None
        self._overlay = self.publisher(topics.DOOR_OVERLAY)
        self._frames = FramePublisher(self) if self.value("frames") else None
        if not self._teller.chosen:
            return
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.CAMERA_INFO, self._take_camera_info)
        self.subscribe(topics.PICTURES[self.value("image_transport")], self._take_picture)
        self.every(LOOK_PERIOD, self._give_up_waiting)

    def start(self) -> None:
        """Say so where there is nothing to do."""
        if not self._teller.chosen:
            self.report(OK, self._teller.at_rest)

    def rehearse(self) -> None:
        """Look at a drawn door and draw what is shown of it."""
        picture = picture_message(drawn_door(self._mounted, self._layout), Header())
        found = look(picture, self._mounted, self._layout, FACE)
        picture_message(draw_overlay(picture_of(picture), found)[::2, ::2], Header())
        pose_message(found.T_base_door)

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        self._recipe = recipe
        self._prepare()

    def _prepare(self) -> None:
        """Work out what does not depend on the picture before it comes."""
        if self._camera is not None and self._recipe is not None:
            with suppress(LocalizationError):  # said when the picture comes
                prepare(self._camera, self._layout, self._recipe.width, self._recipe.thickness)

    def _take_camera_info(self, info: CameraInfo) -> None:
        roi = info.roi
        window = (info.binning_x, info.binning_y, roi.x_offset, roi.y_offset, roi.width, roi.height)
        intrinsics = (info.width, info.height, *window, info.distortion_model, *info.k, *info.d)
        if intrinsics != self._intrinsics:
            self._take_intrinsics(info)
            self._intrinsics = intrinsics
        if self._waiting is not None:
            (picture, _), self._waiting = self._waiting, None
            self._localize(picture)

    def _take_intrinsics(self, info: CameraInfo) -> None:
        """What came before does not go on where what comes now is of no use."""
        try:
            self._camera, self._unusable = camera_of(info, self._mounted), None
        except LocalizationError as error:
            self._camera, self._unusable = None, error
            self.report(WARN, error.message, error_code=error.code)
        self._prepare()

    def _take_picture(self, picture: Picture) -> None:
        if self._camera is None and self._unusable is None:
            self._waiting = (picture, time.monotonic() + self.value("camera_info_wait"))
        else:
            self._localize(picture)

    def _give_up_waiting(self) -> None:
        if self._waiting is not None and time.monotonic() > self._waiting[1]:
            (picture, _), self._waiting = self._waiting, None
            self._localize(picture)

    def _localize(self, message: Picture) -> None:
        recipe = self._recipe
        if recipe is None:
            self.report(WARN, "a picture came while no recipe is in hand; it is left aside")
            return
        now = self.get_clock().now().nanoseconds
        age = ns_to_s(now - nanoseconds_of(message.header.stamp))
        answer = DoorLocalization(run_id=recipe.run_id, door_id=recipe.door_id)
        answer.header.stamp = message.header.stamp
        answer.header.frame_id = BASE_FRAME
        begun = time.perf_counter()
        try:
            if self._unusable is not None:
                raise self._unusable
            found = look(
                message, self._camera, self._layout, recipe, age=age if self.value("check_age") else 0.0
            )
        except Exception as unexpected:  # whatever it is, the run waits for an answer
            error = self.as_refusal(unexpected)
            answer.duration = time.perf_counter() - begun
            answer.error_code = error.code
            answer.reason = error.message
            self._teller.refuse(answer)
            said = f"door {recipe.door_id}: {error.message}"
            drift = error.data.get("drift")
            if drift is not None:
                said = said.replace(drift.sentence, self._tell_drift(drift, answer.header))
            self.report(WARN, said, error_code=error.code)
            reason = error
            self.later("show", lambda: self._show_refusal(message, reason))
            return
        answer.duration = time.perf_counter() - begun
        self._publish(answer, found, recipe.width)
        values = {"door_id": recipe.door_id, "residual": found.residual, "quality": found.quality}
        if self._mounted.empty and empty_clamp_for(self._mounted.empty, recipe.width) is None:
            values["empty_clamp"] = f"no picture for this width, only for {widths_told(self._mounted.empty)}"
        told = "" if found.drift is None else self._tell_drift(found.drift, answer.header)
        if found.drift is not None:
            values["camera"] = f"{found.drift.share:.2f} of what marks.limit allows"
        if found.clamp is not None and found.clamp.stale:
            values["error_code"] = StaleEmptyClamp.code
            told = f"{told}; {found.clamp.sentence}" if told else found.clamp.sentence
        self.report(WARN if told else OK, f"door found, but {told}" if told else "door found", **values)
        self.later("show", lambda: self._show(message, found, recipe.width))

    def _tell_drift(self, drift: Drift, header: Header) -> str:
        """Put on record how the camera stands; what is to be said of it."""
        if self._moved is not None:
            message = TwistStamped(header=header)
            twist = message.twist
            twist.linear.x, twist.linear.y, twist.linear.z = drift.nearer, *map(float, drift.moved[1:])
            twist.angular.x, twist.angular.y, twist.angular.z = map(float, drift.turned)
            self._moved.publish(message)
        return self._marks.told(drift, seconds_of(header.stamp))

    def _show(self, message: Picture, found: Localization, width: float) -> None:
        """What people look at."""
        if self._frames is not None:
            T_base_camera = (self._camera or self._mounted).T_base_camera(width)
            self._frames.show(
                [
                    LinkPose(BASE_FRAME, CAMERA_FRAME, T_base_camera),
                    *([LinkPose(BASE_FRAME, DOOR_FRAME, found.T_base_door)] if self._teller.first else []),
                ]
            )
        self._show_overlay(message, lambda picture: draw_overlay(picture, found))

    def _show_refusal(self, message: Picture, reason: DoormillError) -> None:
        """Where the picture was refused for what; nothing of a picture that is none."""
        try:
            self._show_overlay(message, lambda picture: draw_refusal(picture, reason))
        except LocalizationError:
            return

    def _show_overlay(self, message: Picture, draw: Callable[[ByteArray], ByteArray]) -> None:
        step = self.value("overlay_step")
        if step:
            self._overlay.publish(picture_message(draw(picture_of(message))[::step, ::step], message.header))

    def _publish(self, answer: DoorLocalization, found: Localization, width: float) -> None:
        answer.residual, answer.quality = found.residual, found.quality
        self._teller.tell(answer, found.T_base_door, width, found.whole_covariance, found.sees)


def main() -> int:
    """Run the node, on one core: a second one has the other nodes to run."""
    cv2.setNumThreads(1)
    return run_nodes(DoorLocalizer)


if __name__ == "__main__":
    sys.exit(main())
