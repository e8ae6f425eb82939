"""What docs/workspace.md prints beside the kept run of bench/placements.py."""

from __future__ import annotations

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.tools.workspace import TABLE_4_6
from doormill_ros.workspace.doors import DoorRange, thesis_box
from support.page_figures import number_of

TRAVEL = tuple(map(float, DoorRange().travel()))
AT_THE_BOTTOM, AT_THE_TOP = TABLE_4_6[0][4], TABLE_4_6[2][4]
_RUN = "bench/results/placements.txt#"
_ASIDE = number_of(_RUN + r"where \|y\| < ([\d.]+)")
_WIDTHS = DoorRange().width
#: Half a metre of flange y is a metre of width; the middle of the range stands straight ahead.
_MIDDLE = sum(_WIDTHS) / 2.0
NARROWEST, WIDEST = _MIDDLE - 2.0 * _ASIDE, _MIDDLE + 2.0 * _ASIDE
LOWEST = number_of(_RUN + r", z = ([\d.]+) to [\d.]+; straight") + DoorRange().hinge_end
HIGHEST = number_of(_RUN + r", z = [\d.]+ to ([\d.]+); straight") + DoorRange().hinge_end


def aside() -> float:
    """How far the stiffest place is to the side of the thesis' [m]."""
    return number_of(_RUN + r"IRB 6600, stiffness: .*, y (-?[\d.]+) to") - float(thesis_box().corner[1])


def further_right() -> float:
    """Hinge edge of the cell's narrowest door, against flange y of table 4.5 [m]."""
    return float(thesis_box().corner[1]) + TRAVEL[1] - (load_layout().centre_y - _WIDTHS[0] / 2.0)
