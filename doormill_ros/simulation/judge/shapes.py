"""Distances of capsules, boxes and cylinders from a box, many poses at once.

Each function gives the gap between bodies in the frame of a box: positive, never more than the distance between
them; negative, less the way by which the body must be shifted to come free. Two convex bodies are apart exactly
where some axis separates them (separating axis theorem, Gottschalk et al. 1996, OBBTree, section 5).
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

TINY = 1e-12  #: length below which a direction has none


def segment_gap(start: FloatArray, end: FloatArray, radius: float, half: FloatArray) -> FloatArray:
    """Gap between capsules and the box; exact where they are apart.

    Args:
        start: Ends of the capsules' axes in the box's frame, shape (n, 3) [m].
        end: The other ends, shape (n, 3) [m].
        radius: Of the capsules [m].
        half: Half the box's extents, shape (3,) [m].

    Returns:
        Shape (n,) [m].
    """
    near = nearest_on_segment(start, end, half)
    distance = np.linalg.norm(np.maximum(np.abs(near) - half, 0.0), axis=1)
    axes = np.concatenate([_box_axes(len(start)), _edge_axes((end - start)[:, None, :])], axis=1)
    inside = _axis_gap(axes, 0.5 * (start + end), _segment_support(axes, 0.5 * (end - start)), half)
    gap: FloatArray = np.where(distance > 0.0, distance, inside) - radius
    return gap


def cylinder_gap(start: FloatArray, end: FloatArray, radius: FloatArray, half: FloatArray) -> FloatArray:
    """Gap between cylinders with flat ends and the box.

    Args:
        start: Middles of the cylinders' ends in the box's frame, shape (n, 3) [m].
        end: Middles of the other ends, shape (n, 3) [m].
        radius: Of the cylinders, shape (n,) [m].
        half: Half the box's extents, shape (3,) [m].

    Returns:
        Shape (n,) [m].
    """
    along = end - start
    unit = along / np.linalg.norm(along, axis=1, keepdims=True)
    near = nearest_on_segment(start, end, half)
    to_box = near - np.clip(near, -half, half)
    axes = np.concatenate(
        [_box_axes(len(start)), _edge_axes(along[:, None, :]), unit[:, None], _unit(to_box[:, None])], axis=1
    )
    cosine = np.einsum("nki,ni->nk", axes, unit)
    rim = radius[:, None] * np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    support = _segment_support(axes, 0.5 * along) + rim
    return _axis_gap(axes, 0.5 * (start + end), support, half)


def box_gap(centre: FloatArray, rotation: FloatArray, extent: FloatArray, half: FloatArray) -> FloatArray:
    """Gap between boxes and the box.

    Args:
        centre: Of the bodies in the box's frame, shape (n, 3) [m].
        rotation: Their axes as columns, shape (n, 3, 3).
        extent: Half their extents, shape (3,) [m].
        half: Half the box's extents, shape (3,) [m].

    Returns:
        Shape (n,) [m].
    """
    own = np.swapaxes(rotation, 1, 2)  # rows are the body's axes
    axes = np.concatenate([_box_axes(len(centre)), own, _edge_axes(own)], axis=1)
    support = np.abs(np.einsum("nki,nji->nkj", axes, own)) @ extent
    return _axis_gap(axes, centre, support, half)


def nearest_on_segment(start: FloatArray, end: FloatArray, half: FloatArray) -> FloatArray:
    """Point of each segment nearest to the box about the origin, shape (n, 3) [m].

    The squared distance along a segment is convex and of second order between the places at which the segment
    passes a plane of the box, so its slope is linear there and its zero is found exactly.
    """
    along = end - start
    safe = np.where(np.abs(along) > TINY, along, np.inf)
    passes = np.concatenate([(half - start) / safe, (-half - start) / safe], axis=1)
    ends = np.broadcast_to([0.0, 1.0], (len(start), 2))
    share = np.sort(np.clip(np.concatenate([passes, ends], axis=1), 0.0, 1.0), axis=1)  # (n, 8)
    points = start[:, None] + share[..., None] * along[:, None]
    outside = points - np.clip(points, -half, half)
    slope = np.einsum("nki,ni->nk", outside, along)  # rises with the share
    rises = slope >= 0.0
    last = np.where(rises.any(axis=1), rises.argmax(axis=1), share.shape[1] - 1)
    first = np.maximum(last - 1, 0)
    row = np.arange(len(start))
    low, high = slope[row, first], slope[row, last]
    part = np.where(high > low, -low / np.where(high > low, high - low, 1.0), 0.0)
    at = share[row, first] + np.clip(part, 0.0, 1.0) * (share[row, last] - share[row, first])
    at = np.where(high < 0.0, 1.0, np.where(last == 0, 0.0, at))
    nearest: FloatArray = start + at[:, None] * along
    return nearest


def _box_axes(count: int) -> FloatArray:
    axes: FloatArray = np.broadcast_to(np.eye(3), (count, 3, 3))
    return axes


def _edge_axes(directions: FloatArray) -> FloatArray:
    """Cross products of the box's axes with directions (n, k, 3), shape (n, 3 k, 3), unit or zero."""
    crossed = np.cross(np.eye(3)[None, :, None], directions[:, None])
    return _unit(crossed.reshape(len(directions), -1, 3))


def _unit(vectors: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: FloatArray = np.where(length > TINY, vectors / np.where(length > TINY, length, 1.0), 0.0)
    return unit


def _segment_support(axes: FloatArray, half_along: FloatArray) -> FloatArray:
    support: FloatArray = np.abs(np.einsum("nki,ni->nk", axes, half_along))
    return support


def _axis_gap(axes: FloatArray, centre: FloatArray, support: FloatArray, half: FloatArray) -> FloatArray:
    """Largest gap of all axes; an axis of length zero says nothing."""
    gap = np.abs(np.einsum("nki,ni->nk", axes, centre)) - support - np.abs(axes) @ half
    said = np.einsum("nki,nki->nk", axes, axes) > 0.5
    largest: FloatArray = np.where(said, gap, -np.inf).max(axis=1)
    return largest
