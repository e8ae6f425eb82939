"""Says which poses a next series should hold: joint angles not visited, parameters known least."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.document import BINS, covered
from doormill_ros.units import rad_to_deg

#: Poses for a degree of an unvisited range that give the highest listed orders three samples a wave.
_PER_BIN = 10


def plan_next(diagnosis: PoseDiagnosis) -> str:
    """One sentence, computed from coverage and the standard deviations of the fit."""
    wanted = []
    for k in range(6):
        visited = covered(np.concatenate([data.q[:, k] for data in diagnosis.sets]))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~visited, [False]]).astype(int))).reshape(
            -1, 2
        )
        if len(edges):
            low, high = max(edges.tolist(), key=lambda e: e[1] - e[0])
            a, b = rad_to_deg(np.array([low, high]) * 2.0 * np.pi / BINS - np.pi)
            wanted.append(((high - low) / BINS, f"joint {k + 1} from {a:.0f} to {b:.0f} deg"))
    wanted.sort(reverse=True)
    parts = []
    if wanted:
        ranges = ", ".join(text for _, text in wanted[:3])
        parts.append(
            f"take at least {_PER_BIN} poses for every 5 deg of the widest ranges no series has visited ({ranges})"
        )
    weakest = _weakest(diagnosis)
    if weakest:
        parts.append(f"vary the postures that tell {weakest} apart, it is known least for its size")
    parts.append(
        "come to each pose from both sides, since the last motion is read from the row before"
        if len(diagnosis.sets) > 1
        else "take a second series with another placement, to see what holds beyond this one"
    )
    return "; ".join(parts).capitalize() + "."


def _weakest(diagnosis: PoseDiagnosis) -> str:
    """The established cause whose main coefficient is known least for its size."""
    layout = diagnosis.extended.problem.layout
    found = []
    for index, cause in enumerate(layout.causes):
        x, std = diagnosis.extended.problem.x[layout.part(index)], diagnosis.std[layout.part(index)]
        found.append((float(np.max(np.abs(x) / np.maximum(std, 1e-30))), repr(cause).replace("_", " ")))
    return min(found)[1] if found else ""
