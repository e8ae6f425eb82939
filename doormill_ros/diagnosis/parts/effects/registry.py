"""What is looked for in inspected doors: one line an effect."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.loading.patterns import unnamed_patterns
from doormill_ros.diagnosis.parts.doors.late import LAGS
from doormill_ros.diagnosis.parts.effects.case import TOOL
from doormill_ros.diagnosis.parts.effects.door import YieldingDoor
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.diagnosis.parts.effects.elastic import ElasticEffect, Gap, MillBending
from doormill_ros.diagnosis.parts.effects.force import ForceScale, ForceTurn
from doormill_ros.diagnosis.parts.effects.geometry import INNER_LINKS, LinkOffsets
from doormill_ros.diagnosis.parts.effects.hardening import Hardening
from doormill_ros.diagnosis.parts.effects.lag import PathLag, ServoLag
from doormill_ros.diagnosis.parts.effects.shift import ArmWarming, Place, Tilt, Warming, shifts
from doormill_ros.diagnosis.parts.effects.weight import weights
from doormill_ros.robot_model.elastic.causes.base_compliance import BaseCompliance
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.causes.tool_compliance import ToolCompliance
from doormill_ros.robot_model.elastic.places import JOINTS

#: Torques from which a gap is tried as open [N m]: what one between neighbours leaves passes for no other cause.
CROSSINGS = (0.0, 2.0, 5.0, 10.0, 20.0)
#: Places of the cell from which on they tell one link, which has four numbers, from the others, camera and clamp.
PLACES_OF_LINKS = 8
#: Time constants of warming that are tried [h]: preferred numbers of series R 10 (ISO 3). One between neighbours leaves
#: so little that it passes for nothing else.
REST = (0.25, 0.315, 0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)
#: Shapes without a name that doors can show: of a load, not of its time, and not of a tracker. A turn with the last
#: motion whatever the load is not among them: where the load always comes from one side and a door may have stood
#: anywhere, it is the same as a gap.
_SHAPES = (
    "joint_ripple",
    "joint_one_sided_spring",
    "joint_square_law",
    "joint_cubic_law",
    "joint_dead_zone",
    "link_torsion",
    "bearing_shift",
    "base_shift",
    "base_turn",
)


def effects(
    kinds: Sequence[str], tools: Sequence[str], q: FloatArray, warming: bool, places: int
) -> list[Effect]:
    """Everything that may be wrong, and the shapes that may not be named.

    Args:
        kinds: Of the features that were measured.
        tools: That cut them.
        q: Joint angles where the points were cut, shape (n, 6) [rad].
        warming: Whether the doors are from times far enough apart.
        places: In how many places of the cell features were milled.
    """
    mills = (TOOL, *(tools if len(tools) > 1 else ()))
    where_cut = (TOOL, *(kinds if len(kinds) > 1 else ()), *mills[1:])
    none = np.zeros(len(q))
    shapes = unnamed_patterns(q, none, np.full(len(q), np.nan), none)
    return [
        *shifts(mills),
        *weights(),
        *(kind(hours) for kind in (Warming, ArmWarming) for hours in (REST if warming else ())),
        *(ForceScale(where) for where in where_cut),
        *(ForceTurn(where) for where in where_cut),
        *(ElasticEffect(JointStiffness(where)) for where in JOINTS),
        *(Hardening(where) for where in JOINTS),
        *(Gap(where, crossing) for where in JOINTS for crossing in CROSSINGS),
        *(MillBending(where) for where in mills),
        ElasticEffect(ToolCompliance("flange")),
        ElasticEffect(BaseCompliance("base")),
        PathLag(),
        *(ServoLag(lag) for lag in LAGS),
        *(LinkOffsets(where) for where in (INNER_LINKS if places >= PLACES_OF_LINKS else ())),
        Tilt(),
        YieldingDoor(),
        Place(),
        *(ElasticEffect(shape) for shape in shapes if shape.name in _SHAPES),
    ]
