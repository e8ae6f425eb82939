"""The scale of the thesis, section 3.7: a length by which a door was moved over the pixels that it went."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.calibration.moved_door import SeenDoor
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.sensors.edge_rays import seen


def thesis_scale(
    looked: list[SeenDoor], before: CameraModel, after: CameraModel, axis: int
) -> tuple[float, float]:
    """Length per pixel [m] along a base axis, as the thesis finds it and by the found camera."""
    at_rest = [item for item in looked if not np.any(item.moved.move)]
    for item in looked:
        shift = item.moved.move
        if shift[axis] and not np.any(np.delete(shift, axis)):
            for rest in at_rest:
                if rest.moved.door == item.moved.door:
                    corners = [before.distort(_corner(x)) for x in (item, rest)]
                    length = abs(float(shift[axis]))
                    model = [
                        after.distort(
                            seen(x.T_base_door, after.T_base_camera(x.moved.door.width), 1, np.zeros(1))
                        )[0]
                        for x in (item, rest)
                    ]
                    return (
                        length / float(np.linalg.norm(corners[0] - corners[1])),
                        length / float(np.linalg.norm(model[0] - model[1])),
                    )
    return float("nan"), float("nan")


def _corner(item: SeenDoor) -> FloatArray:
    """Ideal ray (2,) where straight lines through the two edges cross."""
    lines = []
    for e in item.edges:
        middle = e.rays.mean(axis=0)
        across = np.linalg.svd(e.rays - middle)[2][1]
        lines.append((across, across @ middle))
    return np.linalg.solve(np.array([n for n, _ in lines]), np.array([d for _, d in lines]))
