"""What lies beyond the edges that were found: outside of a door there is background, as far as the picture shows it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import Surfaces
from doormill_ros.localization.view import EDGES, HINGE, FaceView
from doormill_ros.statistics import row_medians, running_means, share

_PITCH = 0.4e-3  # between parallels [m]
_WING = 3  # parallels averaged on each side of a step
_INSIDE = 2.0e-3  # where parallels begin, inside of the edge [m]
_CLEAR = 2.4e-3  # what is so near outside of the edge belongs to it or to its rim [m]
_REACH = 60.0e-3  # parallels end there, outside of the edge, or with the picture [m]
_ALONG = (4.0e-3, 44.0e-3, 1.6e-3)  # where they are read, from the corner, and how closely [m]
_FAINTEST = 6.0  # smallest step that is looked for [grey levels]
_STEADY = 0.8  # a step runs along the edge where that share of its samples has half of it


def larger_beyond(picture: ByteArray, view: FaceView, pose: FloatArray) -> bool:
    """Whether a larger step runs along an edge further out than the one that was found.

    The door may stand out of range then, and what was found be the inner border of its lipping, or a rail lies
    behind it: a closer look has to tell.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        pose: Rough pose of the corner, y, z [m] and rotation [rad], shape (3,).
    """
    sight = Surfaces(picture, view)
    offsets = np.arange(_INSIDE, -_REACH, -_PITCH)
    edge_at = round(_INSIDE / _PITCH) - _WING
    first = edge_at + round(_CLEAR / _PITCH)
    for edge in EDGES:
        line = EdgeLine.at_pose(edge, pose, 0.0)
        corner = float(pose[1] if edge == HINGE else pose[0])
        along = corner + np.arange(*_ALONG)
        grey = sight.rows(edge, line.across + offsets, line.tilt, along).astype(np.float32)
        means = running_means(grey.T, _WING).T
        steps = means[:-_WING] - means[_WING:]
        sizes = row_medians(steps)
        at = first + int(np.argmax(np.abs(sizes[first:])))
        own = float(np.abs(sizes[edge_at - 1 : edge_at + 2]).max())
        size = float(sizes[at])
        there = np.sign(size) * steps[at] > 0.5 * abs(size)
        if abs(size) > max(own, _FAINTEST) and share(there) >= _STEADY:
            return True
    return False
