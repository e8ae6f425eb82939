"""What was measured on a milled door."""

from __future__ import annotations

from datetime import datetime

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorInspection
from doormill_ros.frames import DOOR_FRAME
from doormill_ros.measurements.inspections.inspection import CAMERA
from doormill_ros.measurements.inspections.inspection_writer import MeasuredPoints
from doormill_ros.units import s_to_ns


def inspection_message(
    points: MeasuredPoints, run_id: str, measured_at: datetime, noise: float, datum: str = CAMERA
) -> DoorInspection:
    """What was measured on a door, as a message.

    Args:
        points: What was measured.
        run_id: The run that milled the door.
        measured_at: With its zone.
        noise: Standard deviation of one deviation [m].
        datum: What the deviations are against; by default where the recorded pose put the door.
    """
    seconds, nanoseconds = divmod(s_to_ns(measured_at.timestamp()), 1_000_000_000)
    stamp = Time(sec=seconds, nanosec=nanoseconds)
    return DoorInspection(
        header=Header(stamp=stamp, frame_id=DOOR_FRAME),
        run_id=run_id,
        noise=noise,
        datum=datum,
        feature=list(points.feature),
        wall=[surface == "wall" for surface in points.surface],
        point=[Point(x=x, y=y, z=z) for x, y, z in points.point.tolist()],
        normal=[Vector3(x=x, y=y, z=z) for x, y, z in points.normal.tolist()],
        deviation=points.deviation.tolist(),
    )
