"""Node /folder_camera: the pictures of a folder, one a run, as if a camera took them."""

from __future__ import annotations

import array
import sys
from pathlib import Path
from typing import Any

from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorRecipe
from doormill_ros.cell.graph.node_names import FOLDER_CAMERA
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.picture_folder import PictureFolder
from doormill_ros.messages.picture import picture_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN
from doormill_ros.nodes.convert.picture import camera_info_message, picture_message
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.sensing.requested_camera import RequestedCamera


class FolderCamera(RequestedCamera):
    """Plays the camera with pictures that somebody brought; one that cannot be read is sent as an empty one.

    What was given out is known as long as the node runs: one that is started again begins with the first picture.
    """

    PARAMETERS = (
        NodeParameter("folder", "out/pictures", "folder with PNG or JPEG files, taken in the order of names"),
        NodeParameter("camera", "", "camera file of the pictures; empty: config/camera.yaml"),
        NodeParameter("retry_period", 1.0, "a picture that nobody used is sent again after [s]", 0.1, 3600.0),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(FOLDER_CAMERA, **kwargs)

    def setup(self) -> None:
        """Read the camera file; subscribe."""
        self._folder = PictureFolder(Path(self.value("folder")))
        self._camera = load_camera(Path(self.value("camera")) if self.value("camera") else None)
        self._taken: tuple[str, Image] | None = None
        self.open_camera(self.value("retry_period"))
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.get_logger().info(
            f"{self._folder.left} pictures wait in {self._folder.path}, the first of them is next: those that were "
            "used before this start are not known, take them out"
        )

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        if self.is_new(recipe.run_id):
            self.want(recipe.run_id)

    def picture(self, run_id: str) -> Image | None:
        """The next one of the folder for each run, the same as long as the run wants one."""
        if self._taken is None or self._taken[0] != run_id:
            path = self._folder.take()
            if path is None:
                self.report(WARN, f"no picture is left in {self._folder.path}; put one there")
                return None
            self._taken = run_id, self._read(path)
        return self._taken[1]

    def _read(self, path: Path) -> Image:
        """A file's picture; of one that cannot be read an empty one, so that the run is answered."""
        try:
            data = array.array("B", self._folder.read(path))
            picture = picture_message(picture_of(CompressedImage(data=data)), Header())
        except BadPicture as error:
            self.report(ERROR, f"{path}: {error.message}", error_code=error.code)
            return Image(encoding="mono8")
        self.report(OK, "picture taken", file=path.name, left=self._folder.left)
        return picture

    def camera_info(self, header: Header) -> CameraInfo:
        """That of the camera file."""
        return camera_info_message(self._camera.k, self._camera.distortion, self._camera.size, header)


def main() -> int:
    """Run the node."""
    return run_nodes(FolderCamera)


if __name__ == "__main__":
    sys.exit(main())
