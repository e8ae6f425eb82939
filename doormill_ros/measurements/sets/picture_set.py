"""Reads a picture set: pictures of one door that was moved by known amounts before the cell's camera.

A folder with set.yaml

    schema: doormill/picture-set/1
    camera: camera.yaml            # form of config/camera.yaml, beside this file; without it that of the cell
    door: {width: 0.826, thickness: 0.040}      # m

and pictures.csv, one picture a row with the columns picture (a file in the folder), t [s] and y, z [m] and
rotation [rad], where the door stood from its nominal place.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.cell.places.layout import OFFSETS, DoorOffset
from doormill_ros.files import is_file
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.picture_file import read_picture
from doormill_ros.localization.settings import LocalizerSettings, load_settings
from doormill_ros.measurements.documents.schemas import PICTURE_SET
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.trial_table import TrialTable
from doormill_ros.resources import resource

COLUMNS = ("picture", "t", *OFFSETS)


@dataclass(frozen=True, eq=False)
class PictureSet:
    """Pictures of a door at known places.

    Attributes:
        path: The folder.
        camera: The camera model that is questioned.
        settings: The localizer's, of the same file.
        width, thickness: Of the door [m].
        names: File of each picture in the folder, n of them.
        time: When each was taken, shape (n,) [s].
        moved: Where the door stood from its nominal place: y, z and rotation, shape (n, 3) [m, m, rad].
        table: The table, for complaints about a row.
    """

    path: Path
    camera: CameraModel
    settings: LocalizerSettings
    width: float
    thickness: float
    names: tuple[str, ...]
    time: FloatArray
    moved: FloatArray
    table: TrialTable

    def __len__(self) -> int:
        return len(self.names)

    def offset(self, row: int) -> DoorOffset:
        """Where the door stood in a picture."""
        return DoorOffset(*(float(value) for value in self.moved[row]))

    def picture(self, row: int) -> ByteArray:
        """A grey picture, shape (h, w).

        Raises:
            TrialTableError: The file named in the table is no picture.
        """
        try:
            return read_picture(self.path / self.names[row])
        except BadPicture as error:
            raise self.table.fail(
                row, "picture", f"{self.names[row]!r} is no PNG or JPEG in the folder"
            ) from error


def read_picture_set(folder: Path) -> PictureSet:
    """Read set.yaml and pictures.csv; the pictures are read when they are asked for.

    Raises:
        DataSetError: A file is missing, or a value cannot be used; the message names file, line and column.
        BadCameraFile: The camera file cannot be used.
    """
    document = SetDocument(folder / "set.yaml")
    document.check_schema(PICTURE_SET)
    camera_file = resource("config/camera.yaml")
    if document.data.get("camera") is not None:
        camera_file = folder / document.text("camera")
        if not is_file(camera_file):
            raise document.fail(
                ("camera",), f"is {document.get('camera')!r}, allowed is a file in the folder"
            )
    table = TrialTable(folder / "pictures.csv", COLUMNS)
    time, moved = table.numbers("t"), table.block(OFFSETS)
    for row in np.flatnonzero(np.diff(time) < 0.0):
        raise table.fail(int(row) + 1, "t", f"{time[row + 1]:g} follows {time[row]:g}, times have to ascend")
    for array in (time, moved):
        array.setflags(write=False)
    return PictureSet(
        path=folder,
        camera=load_camera(camera_file),
        settings=load_settings(camera_file),
        width=document.number("door", "width", positive=True),
        thickness=document.number("door", "thickness", positive=True),
        names=tuple(table.text("picture")),
        time=time,
        moved=moved,
        table=table,
    )
