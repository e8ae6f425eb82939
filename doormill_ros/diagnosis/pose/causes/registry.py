"""All causes that are looked for in pose sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from doormill_ros.diagnosis.pose.causes.cause import PoseCause
from doormill_ros.diagnosis.pose.causes.joint_backlash import JointBacklash
from doormill_ros.diagnosis.pose.causes.joint_periodic_error import BROAD, JointPeriodicError
from doormill_ros.diagnosis.pose.causes.joint_sag import JointSag
from doormill_ros.diagnosis.pose.causes.joint_wobble import JointWobble
from doormill_ros.diagnosis.pose.causes.link_geometry import LinkGeometry
from doormill_ros.diagnosis.pose.causes.session_step import SessionStep
from doormill_ros.diagnosis.pose.causes.thermal_drift import ThermalDrift
from doormill_ros.diagnosis.pose.pose_set import PoseSet
from doormill_ros.diagnosis.pose.view import make_view

#: Waves of a tilting axis; one wave a turn is, in the main, a wrong alpha or theta of the links next to it.
WOBBLE_ORDERS = (2, 3, 4)
#: Orders that are tried for a joint's own angle without a hint where rows are few.
SPARSE = 16
MANY_ROWS = 2500
#: Torque of gravity below which a joint's sag cannot be asked for [N m].
LEAST_TORQUE = 0.5


def dense_orders(sets: Sequence[PoseSet]) -> tuple[int, ...]:
    """Orders that are tried without any hint."""
    rows = sum(len(data) for data in sets)
    return tuple(range(1, (BROAD if rows >= MANY_ROWS else SPARSE) + 1))


def candidates(
    sets: Sequence[PoseSet],
    orders: Mapping[int, Sequence[int]],
    steps: Mapping[int, int] | None = None,
    drift: bool = True,
) -> list[PoseCause]:
    """Every cause at every place.

    Args:
        sets: The series.
        orders: Orders of the periodic error by joint number.
        steps: First row after a step by index of the series, where one is suspected.
        drift: Whether to look for slow displacements within a series.
    """
    first = sets[0]
    library: list[PoseCause] = [LinkGeometry(f"link {k}", first.dh) for k in range(1, 6)]
    moment = [make_view(data).gravity_moment for data in sets]
    for k in range(1, 7):
        spread = max(float(abs(m[:, k - 1, 2]).max()) for m in moment)
        if spread > LEAST_TORQUE:
            library.append(JointSag(f"joint {k}"))
    library += [JointPeriodicError(f"joint {k}", orders[k]) for k in range(1, 7)]
    library += [JointWobble(f"joint {k}", WOBBLE_ORDERS) for k in range(1, 7)]
    library += [JointBacklash(f"joint {k}") for k in range(1, 7)]
    for index, data in enumerate(sets):
        if drift:
            library.append(ThermalDrift(f"set {data.name}"))
        if steps and index in steps:
            library.append(SessionStep(f"set {data.name}", steps[index]))
    return library
