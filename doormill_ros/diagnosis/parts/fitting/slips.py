"""Points at which the gauge slipped, told by their neighbours before anything is fitted.

Where a door stands is taken from all of its rows before these are weighed, so that one slip would be spread over the
whole door. No mill leaves a single point a millimetre beside those around it: where a joint turns back the wall steps
by its gap, and has points on both sides of the step.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.examining.stability import clustered
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis, DoorProblem
from doormill_ros.measurements.inspections.inspection import Inspection
from doormill_ros.statistics import GROSS_SHARE, median
from doormill_ros.units import m_to_mm

#: By which a slip is beside all but one of its neighbours; drawn worlds leave less than 0.4 mm [m].
BESIDE = 1e-3
#: By which a slip is beside the middle of a surface that has fewer points; no door may be as far off [m].
BEYOND = 4e-3
#: Standard deviations by which a slip is beside what was found; drawn worlds leave less than six.
FAR = 20.0
_FEW = 0.03  #: share of the points that may be slips of that kind; more are an effect
_NEIGHBOURS = 6
_ALONE = 2.0  #: times what its neighbours are beside what was found, or each other, that a slip is further
_ENOUGH = 20  #: points of a surface whose neighbours are near
_FEWEST = 3  #: points that have a middle


def slips(inspection: Inspection) -> BoolArray:
    """Points at which the gauge slipped, shape (n,).

    Raises:
        TrialTableError: They are too many for that.
    """
    found = np.zeros(len(inspection), dtype=bool)
    feature = np.array(inspection.feature)
    for name in dict.fromkeys(inspection.feature):
        for wall in (True, False):
            rows = np.flatnonzero((feature == name) & (inspection.wall == wall))
            off = inspection.deviation[rows]
            if len(rows) >= _ENOUGH:
                point = inspection.point[rows]
                near = cKDTree(point).query(point, k=_NEIGHBOURS + 1)[1][:, 1:]
                # The second: two slips may lie side by side.
                found[rows] = np.sort(np.abs(off[near] - off[:, None]), axis=1)[:, 1] > BESIDE
            elif len(rows) >= _FEWEST:
                found[rows] = np.abs(off - median(off)) > BEYOND
    if found.sum() > max(1, int(GROSS_SHARE * len(found))):
        row = int(found.argmax())
        raise inspection.refuse_point(
            row,
            "deviation",
            f"is {inspection.deviation[row]:g} and {found.sum()} of {len(found)} points lie more than "
            f"{m_to_mm(BESIDE):g} mm beside their neighbours, allowed is one in ten; gauge the door again",
        )
    return found


def slips_beside(diagnosis: DoorDiagnosis) -> BoolArray:
    """Points far beside what was found and beside their neighbours, single ones and few of them, shape (n,).

    Where a door may have stood anywhere a slip displaces all of it: its neighbours are beside what was found, too.
    """
    white = diagnosis.best.prediction.white[:, 0]
    far: BoolArray = ~diagnosis.kept & (np.abs(white) > FAR)
    if far.any():
        about, spread = _about(diagnosis.problem, white)
        far &= np.abs(white - about) > np.maximum(FAR, _ALONE * np.maximum(np.abs(about), spread))
    few = far.sum() <= max(1, int(_FEW * len(far))) and not clustered(diagnosis.problem, far)
    return far if few else np.zeros_like(far)


def _about(problem: DoorProblem, white: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What the nearest points of the same surface leave: the middle of them, and how far apart they are, shape (n,)."""
    points, about, spread = problem.points, np.zeros(len(white)), np.zeros(len(white))
    surface = np.char.add(
        np.char.add(problem.door.astype(str), np.where(points.wall, " w ", " f ")), points.feature
    )
    for one in np.unique(surface):
        rows = np.flatnonzero(surface == one)
        if len(rows) > _NEIGHBOURS:
            near = cKDTree(points.point[rows]).query(points.point[rows], k=_NEIGHBOURS + 1)[1][:, 1:]
            low, about[rows], high = np.quantile(white[rows][near], [0.1, 0.5, 0.9], axis=1)
            spread[rows] = high - low
    return about, spread
