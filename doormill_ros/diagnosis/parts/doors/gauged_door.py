"""One inspected door, matched with the run that milled it."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints


@dataclass(frozen=True, eq=False)
class GaugedDoor:
    """One inspected door.

    Attributes:
        name: Of the inspection.
        run_id: Of the run that milled it.
        recipe: What it is.
        time: When it was gauged, of doors in order when it was milled [s since the epoch].
        points: Measured, and matched with the run.
        noise: Standard deviation of a deviation [m].
        placing: Covariance of y, z and rotation of its pose, shape (3, 3); None where it is not known where it stood.
        T_base_door: Where the door stood as far as the run knew, shape (4, 4) [m].
        eye: Where the camera stood, base frame, shape (3,) [m].
        largest: How far its worst measured point is off, matched or not [m].
        milled: When the tool set out to mill it, by the bag [s since the epoch]; None where that does not tell.
        robot_model: Robot or model.yaml that its path was corrected with; "" for the robot's joint springs.
    """

    name: str
    run_id: str
    recipe: str
    time: float
    points: CutPoints
    noise: float
    placing: FloatArray | None
    T_base_door: FloatArray
    eye: FloatArray
    largest: float = 0.0
    milled: float | None = None
    robot_model: str = ""
