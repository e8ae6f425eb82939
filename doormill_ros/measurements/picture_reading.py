"""Repeated localisations of a door that was moved by known amounts, and how a wrong camera model reads its edges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout, DoorOffset
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.result import Localization
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView

_POINTS = 60  #: along each edge


@dataclass(frozen=True, eq=False)
class DoorReading:
    """What the localizer makes of a door when its camera model is wrong: a line along each edge, their corner.

    The corner is where the whole visible edges say it is. A lens that is undone wrongly bends them, which moves the
    corner and turns the door by other amounts than at the corner's own pixel.

    Attributes:
        camera: The camera model that the localizer used.
        layout: The nominal place of the door.
        width, thickness: Of the door [m].
    """

    camera: CameraModel
    layout: CellLayout
    width: float
    thickness: float

    @property
    def distance(self) -> float:
        """From the projection centre to the face [m]."""
        corner = self.layout.T_base_door(self.width, self.thickness)
        return float(corner[0, 3] - self.camera.T_base_camera(self.width)[0, 3])

    def derivative(
        self, moved: FloatArray, wrong: Callable[[CameraModel, float], CameraModel], step: float
    ) -> FloatArray:
        """Change of the localisations per unit of an error, that of the nominal place taken off, shape (n, 3).

        Args:
            moved: Places of the door, shape (n, 3) [m, m, rad].
            wrong: The camera model with an error of the given size.
            step: Size for which the derivative is taken, to both sides.
        """
        places = np.vstack([moved, np.zeros(3)])
        more, less = (self._read(places, wrong(self.camera, sign * step)) for sign in (1.0, -1.0))
        change = (more - less) / (2.0 * step)
        beside: FloatArray = change[:-1] - change[-1]
        return beside

    def _read(self, places: FloatArray, believed: CameraModel) -> FloatArray:
        true, view = self._view(self.camera), self._view(believed)
        found = np.zeros((len(places), 3))
        for i, place in enumerate(places):
            points = {
                edge: view.points(
                    true.pixels(true.line(edge, place, np.linspace(0.0, true.length(edge), _POINTS)))
                )
                for edge in (HINGE, BOTTOM)
            }
            p, a = np.polyfit(points[HINGE][:, 1], points[HINGE][:, 0], 1)  # y = a + p z
            q, b = np.polyfit(points[BOTTOM][:, 0], points[BOTTOM][:, 1], 1)  # z = b + q y
            y = (a + p * b) / (1.0 - p * q)
            # No door is as square as a picture is sharp: the hinge edge alone says how it is turned.
            found[i] = y, b + q * y, -np.arctan(p)
        return found

    def _view(self, camera: CameraModel) -> FaceView:
        return FaceView(camera, self.layout, self.width, self.thickness)


@dataclass(frozen=True, eq=False)
class Localisations:
    """Repeated localisations; all lengths in the plane of the door.

    Attributes:
        moved: Known y, z and rotation of the door, shape (n, 3) [m, m, rad].
        located: What the pictures gave, shape (n, 3).
        time: When each picture was taken, shape (n,) [s].
        std: Standard deviation of one localisation, shape (3,) [m, m, rad].
        centre: Where the optical axis meets the door plane, y and z, shape (2,) [m].
        reading: How the camera reads the door; None for a pinhole of which no more is known than its `centre`.
    """

    moved: FloatArray
    located: FloatArray
    time: FloatArray
    std: FloatArray
    centre: FloatArray = field(default_factory=lambda: np.zeros(2))
    reading: DoorReading | None = None

    @property
    def place(self) -> FloatArray:
        """Position in the picture's field, from the optical axis, shape (n, 2) [m]."""
        return self.moved[:, :2] - self.centre


def localisations_of(
    found: Sequence[Localization],
    moved: Sequence[DoorOffset],
    time: FloatArray,
    camera: CameraModel,
    layout: CellLayout,
    width: float,
    thickness: float,
) -> Localisations:
    """What the localizer said of pictures of one door, in the form that is questioned.

    Args:
        found: Results, one a picture, by `LocalizerSettings.lens_in_question`: what is wrong alike in all pictures is
            no scatter.
        moved: Where the door was known to stand.
        time: When each picture was taken, shape (n,) [s].
        camera: The camera model that the localizer used.
        layout: The nominal place of the door.
        width: Door width [m].
        thickness: Door thickness [m].
    """
    corner = np.array([layout.centre_y - width / 2.0, layout.bottom_z])
    return Localisations(
        moved=np.array([_numbers(offset) for offset in moved]),
        located=np.array([_numbers(one.offset) for one in found]),
        time=np.asarray(time, dtype=float),
        std=np.sqrt(np.mean([np.diag(one.covariance) for one in found], axis=0)),
        centre=camera.T_base_camera(width)[1:3, 3] - corner,
        reading=DoorReading(camera, layout, width, thickness),
    )


def _numbers(offset: DoorOffset) -> tuple[float, float, float]:
    return offset.y, offset.z, offset.rotation
