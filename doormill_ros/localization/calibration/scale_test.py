"""The thesis' test of a calibrated camera, section 3.7: a door moved by 10 mm is seen to have moved by 10 mm."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.localization.calibration.errors import TooFewPictures
from doormill_ros.localization.calibration.moved_door import MovedDoor
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import LocalizerSettings

_ROOM = 5.0e-3  # m
_MOST = 3.0  # standard deviations


@dataclass(frozen=True, eq=False)
class ScaleTest:
    """One move.

    Attributes:
        number: Of the picture, from 0.
        move: Along base y and z as it was made [m], shape (2,).
        seen: The same as the camera has it [m], shape (2,).
        deviation: Standard deviation of the difference [m].
    """

    number: int
    move: FloatArray
    seen: FloatArray
    deviation: float

    @property
    def off(self) -> float:
        """Distance between both [m]."""
        return float(np.linalg.norm(self.seen - self.move))

    @property
    def passed(self) -> bool:
        """Whether that is no more than the measurement explains."""
        return self.off <= _MOST * self.deviation


def scale_tests(
    moved: list[MovedDoor],
    camera: CameraModel,
    layout: CellLayout,
    settings: LocalizerSettings,
    move_deviation: float = 5.0e-6,
) -> list[ScaleTest]:
    """Localize the door in every picture and compare its moves from the reference place.

    The mounting and the door's shape cancel; what counts is the pictures' scatter, and what lens and thickness do to
    the scale.

    Args:
        moved: The pictures; of each door one at least with no move.
        camera: In question.
        layout: Where the nominal door stands.
        settings: Limits of the localiser, and what is known of lens and thickness.
        move_deviation: Standard deviation of a move [m].

    Raises:
        LocalizationError: A picture is refused.
        TooFewPictures: There is no move, or no picture without one of a door that was moved.
    """
    # A move may leave the range in which doors are milled.
    limits = layout.limits
    wide = replace(layout, limits=replace(limits, y=limits.y + _ROOM, z=limits.z + _ROOM))
    # A door moved along x shows its face nearer or further off.
    found = [
        localize(
            m.picture,
            camera,
            replace(wide, rear_face_x=wide.rear_face_x + float(m.move[0])),
            m.door.width,
            m.door.thickness,
            settings=settings,
        )
        for m in moved
    ]
    tests = []
    for i, (item, place) in enumerate(zip(moved, found, strict=True)):
        if not np.any(item.move[1:]):
            continue
        rest = [p for m, p in zip(moved, found, strict=True) if m.door == item.door and not np.any(m.move)]
        if not rest:
            raise TooFewPictures(
                f"picture {i + 1} shows a moved door, one of the same door with move [0, 0, 0] is needed"
            )
        length = float(np.linalg.norm(item.move[1:]))
        away = layout.rear_face_x - item.door.thickness - camera.position[0]
        scale = float(np.hypot(settings.lens_deviation, settings.thickness_deviation / away))
        scatter = sum(float(np.trace(p.parts.scatter[:2, :2])) for p in (place, rest[0]))
        seen = np.array([place.offset.y - rest[0].offset.y, place.offset.z - rest[0].offset.z])
        deviation = float(np.sqrt(scatter + move_deviation**2 + (scale * length) ** 2))
        tests.append(ScaleTest(i, item.move[1:], seen, deviation))
    if not tests:
        raise TooFewPictures(
            f"{len(moved)} pictures without a move along y or z, one is needed; move the door by 10 mm"
        )
    return tests
