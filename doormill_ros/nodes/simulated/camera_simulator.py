"""Node /camera_simulator: clamps a door somewhere near its place and takes pictures of it."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Any

import numpy as np
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, DoorRecipe
from doormill_ros.cell.graph.door_sensors import chosen_sensors
from doormill_ros.cell.graph.node_names import CAMERA_SIMULATOR
from doormill_ros.cell.places.layout import CAMERA, OFFSETS, DoorOffset, load_layout
from doormill_ros.frames import BASE_FRAME, CAMERA_FRAME
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.nodes.convert.picture import camera_info_message, picture_message
from doormill_ros.nodes.sensing.requested_camera import RequestedCamera
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.nodes.simulated.simulated_shift import WORLD_PARAMETERS, SimulatedShift
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera, Sensor
from doormill_ros.simulation.world.door_truth import DoorTruth

UNSET = 999.0


class CameraSimulator(RequestedCamera):
    """Plays the handling robot and the camera: a door for each recipe, a picture for each request."""

    PARAMETERS = (
        NodeParameter(
            "seed", 0, "of placement and picture noise, with the door's id", 0, 2**31 - 1, live=True
        ),
        NodeParameter(
            "scatter_y", 0.008, "doors stand up to this far off along base y [m]", 0.0, 0.1, live=True
        ),
        NodeParameter(
            "scatter_z", 0.008, "doors stand up to this far off along base z [m]", 0.0, 0.1, live=True
        ),
        NodeParameter(
            "scatter_rotation",
            0.03,
            "doors are turned up to this far about base x [rad]",
            0.0,
            0.5,
            live=True,
        ),
        NodeParameter(
            "offset_y", UNSET, "fixed offset along base y instead [m]; 999: scattered", -1.0, UNSET, live=True
        ),
        NodeParameter(
            "offset_z", UNSET, "fixed offset along base z instead [m]; 999: scattered", -1.0, UNSET, live=True
        ),
        NodeParameter(
            "offset_rotation",
            UNSET,
            "fixed rotation about base x instead [rad]; 999: scattered",
            -1.0,
            UNSET,
            live=True,
        ),
        NodeParameter(
            "noise", 1.0, "share of the sensor's noise; 0.25: the mean of 16 exposures", 0.0, 4.0, live=True
        ),
        NodeParameter(
            "retry_period", 1.0, "a picture that nobody used is taken again after [s]", 0.1, 3600.0
        ),
        NodeParameter("pictures", True, "false: the camera is broken and sends nothing", live=True),
        SENSORS_PARAMETER,
        *WORLD_PARAMETERS,
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(CAMERA_SIMULATOR, **kwargs)

    def setup(self) -> None:
        """Load the true camera; subscribe.

        Raises:
            BadParameterError: The list of sensors is none.
        """
        self._shift = SimulatedShift(self.value("world"), self.value("door_number"))
        self._camera = SceneCamera.load()
        self._layout = load_layout()
        self._looks = CAMERA in chosen_sensors(self._layout, self.value("sensors"))
        self._picture: Image | None = None
        self._placement = self.publisher(topics.DOOR_PLACEMENT)
        self.open_camera(self.value("retry_period"))
        self.subscribe(topics.DOOR_RECIPE, self._place)

    @property
    def _seed(self) -> list[int]:
        """Of the door in hand; each door of a shift has one of its own, the first one that of a cell for one door."""
        return [self.value("seed"), *([self._shift.number] if self._shift.number else [])]

    def _offset(self, recipe: Recipe) -> DoorOffset:
        rng = np.random.default_rng([*self._seed, zlib.crc32(recipe.door_id.encode())])
        drawn = [self.value(f"scatter_{name}") * rng.uniform(-1.0, 1.0) for name in OFFSETS]
        if recipe.placement is not None:  # a recipe that says where the door stands is obeyed
            drawn = [getattr(recipe.placement, name) for name in OFFSETS]
        fixed = [self.value(f"offset_{name}") for name in OFFSETS]
        return DoorOffset(*(d if f == UNSET else f for d, f in zip(drawn, fixed, strict=True)))

    def _sensor(self) -> Sensor:
        share, real = self.value("noise"), Sensor()
        return replace(real, read_noise=share * real.read_noise, gain=share**2 * real.gain)

    def _place(self, message: DoorRecipe) -> None:
        if not self.is_new(message.run_id):
            return
        recipe = recipe_of(message)
        truth = self._shift.begin()
        offset = self._offset(recipe)
        if self._looks:
            self._picture = self._rendered(recipe, offset, truth)
        placement = DoorPlacement(
            run_id=message.run_id,
            door_id=recipe.door_id,
            pose=pose_message(self._layout.T_base_door(recipe.width, recipe.thickness, offset)),
            offset_y=offset.y,
            offset_z=offset.z,
            offset_rotation=offset.rotation,
        )
        placement.header = Header(stamp=self.get_clock().now().to_msg(), frame_id=BASE_FRAME)
        self._placement.publish(placement)
        self.report(OK, "door clamped", door_id=recipe.door_id)
        self.want(message.run_id)

    def _rendered(self, recipe: Recipe, offset: DoorOffset, truth: DoorTruth) -> Image:
        moved, turn = truth.camera_moved
        scene = PictureScene(
            width=recipe.width,
            thickness=recipe.thickness,
            offset=offset,
            camera=replace(self._camera, origin=self._camera.origin + moved, turn=turn),
            layout=self._layout,
            sensor=self._sensor(),
        )
        picture = render_picture(
            scene, zlib.crc32(" ".join(map(str, [*self._seed, recipe.door_id])).encode())
        )
        return picture_message(picture, Header())

    def picture(self, run_id: str) -> Image | None:
        """What was rendered for the door that stands."""
        return self._picture if self.value("pictures") else None

    def camera_info(self, header: Header) -> CameraInfo:
        """Of the true camera."""
        header.frame_id = CAMERA_FRAME
        rows, columns = self._camera.shape
        return camera_info_message(self._camera.matrix, self._camera.brown, (columns, rows), header)
