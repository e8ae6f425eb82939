"""What docs/thesis.md prints of the influence of K_c, of conditioning and of the region of operation."""

from __future__ import annotations

import dataclasses

import numpy as np

from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.units import DEG, rad_to_deg
from doormill_ros.workspace.conditioning import characteristic_length
from doormill_ros.workspace.doors import DoorRange, thesis_box
from doormill_ros.workspace.grid import thesis_grid
from doormill_ros.workspace.maps import WRENCH_SCRIPT, WRENCH_TEXT, Maps, compute_maps
from support.computed_figures.thesis.facts import FACTS
from support.computed_figures.thesis.stiffness import DATA
from support.page_figures import number_of

ROBOT = DATA.robot
GRID = thesis_grid(ROBOT)
STEP = FACTS["complementary_stiffness"]["grid_step_rad"]
ROWS_OF_GRID, COLUMNS_OF_GRID = GRID.shape
#: The script counts a column more, which lies this far beyond the last angle of joint 2 [rad].
SCRIPT_COLUMNS = COLUMNS_OF_GRID + 1
BEYOND = float(GRID.q2[0]) + (SCRIPT_COLUMNS - 1) * STEP - 85.0 * DEG

TEXT, SCRIPT = (compute_maps(ROBOT, GRID, wrench) for wrench in (WRENCH_TEXT, WRENCH_SCRIPT))
NU_P = [float(maps.position_influence.max()) for maps in (TEXT, SCRIPT)]
NU_R = [rad_to_deg(float(maps.rotation_influence.max())) for maps in (TEXT, SCRIPT)]
_PRINTED_P = FACTS["complementary_stiffness"]["bounds"]["nu_p"]
_PRINTED_R = FACTS["complementary_stiffness"]["bounds"]["nu_r_deg"]
OVER_PRINTED_P = [ours / _PRINTED_P for ours in NU_P]
OVER_PRINTED_R = [ours / _PRINTED_R for ours in NU_R]
#: nu_r over the square of nu_p [deg].
SQUARE_OURS = NU_R[0] / NU_P[0] ** 2
SQUARE_PRINTED = _PRINTED_R / _PRINTED_P**2


@dataclasses.dataclass(frozen=True)
class Best:
    """Largest inverse condition number, and joints 2 and 3 there [deg]."""

    value: float
    joint_2: float
    joint_3: float


def _best(maps: Maps) -> Best:
    row, column = np.unravel_index(int(np.argmax(maps.conditioning)), maps.conditioning.shape)
    return Best(
        float(maps.conditioning[row, column]),
        rad_to_deg(float(maps.grid.q2[column])),
        rad_to_deg(float(maps.grid.q3[row])),
    )


LENGTH = characteristic_length(ROBOT)
NORMALIZED = _best(TEXT)
PLAIN = _best(compute_maps(ROBOT, GRID, length=1.0))
_DH = ROBOT.dh.copy()
_DH[0, [1, 2]] = _DH[0, [2, 1]]
EXCHANGED = _best(compute_maps(dataclasses.replace(ROBOT, dh=_DH), GRID, length=1.0))

VALUES_OF_TABLE_4_6 = sum(
    len(corner["q"]) for corner in FACTS["region_of_operation"]["joint_angles_deg"].values()
)
HOME = Kinematics(ROBOT).forward(np.zeros(6))[:3, 3].tolist()
COUNTED = DoorRange()
TRAVEL = COUNTED.travel().tolist()
NARROWER = DoorRange(thickness=(0.030, 0.100), width=(0.290, 1.350)).travel().tolist()
FIRST = thesis_box().corner.tolist()
LAST = (thesis_box().corner + thesis_box().size).tolist()
#: How far the flange at home goes off with the length that the text prints for link 5 [m].
_MISPRINTED = ROBOT.dh.copy()
_MISPRINTED[4, 1] = number_of(r"test/data/thesis/facts.yaml#the text prints ([\d.]+) here")
MISPRINT = float(np.linalg.norm(Kinematics(_MISPRINTED).forward(np.zeros(6))[:3, 3] - HOME))
LINK_5 = float(ROBOT.dh[4, 1])
#: Angles of joints 2 and 3 at which the grid ends, to its step [deg].
LAST_ANGLES = [rad_to_deg(float(angles[-1])) for angles in (GRID.q2, GRID.q3)]
#: How much too long the arm of joint 1 is with the lengths exchanged [m].
TOO_LONG = float(ROBOT.dh[0, 1] - ROBOT.dh[0, 2])
