"""What was taken for a door, held against the picture of the empty clamp.

A line that the empty clamp has at the same place is the border of a jaw, a rail or a plate. Only lines and the
pattern of what lies inside of them are compared: light and shadows differ from picture to picture, and the camera may
have moved a little since. Where the background says that it lies elsewhere by now, lines and pattern are looked for
there, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.localization.empty_clamp.background import PictureShift
from doormill_ros.localization.empty_clamp.empty_clamp import EmptyClamp
from doormill_ros.localization.empty_clamp.stale_clamp import ClampFit
from doormill_ros.localization.errors import NoDoor, WrongEdge
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView
from doormill_ros.statistics import median, row_medians

MOVED = 0.35e-3  #: how far from the edge its line may lie in the picture of the empty clamp [m]
_REACH = 3.0e-3  # how far beside an edge the usual steps of the empty clamp are learned [m]
_NEAR = 1.0e-3  # from where on they are [m]
_PITCH = 1.25e-3  # between the places along an edge [m]
_ALONG = 9  # px along an edge that are averaged
_FROM_CORNER = 1.5e-3  # where they begin [m]
_SIDE, _GAP = 4, 1  # px that a step compares on both sides, and px that a lens spreads it over
_FAINTEST = 0.1  # grey levels that are usual at least
_APART = 3  # px between the places where usual steps are read
_AVERAGED = (1, 3)  # places along an edge: over a few of them a texture lasts and noise does not
_PLAIN = 3.0  # a line stands out when its steps are that many times as large as is usual beside it
_INSIDE = 3.0e-3  # between an edge and the part of the face that is compared [m]
_LARGEST = 50.0e-3  # side of that part [m]
# Between the points at which its brightness and its pattern are read [m].
_BRIGHT_SAMPLE, _SAMPLE = 4.0e-3, 0.5e-3
_FINE, _COARSE = 3, 11  # of the latter over which noise, and what light makes, are averaged
_CLIPPED = 4.0  # medians of a pattern
_ALIKE = 0.7  # correlation of two patterns that are one
_AS_BRIGHT = 2.0  # ratio of brightness that light and shadows make of one surface


@lru_cache(maxsize=4)  # large, and wanted of the width in hand
def smoothed(clamp: EmptyClamp) -> dict[str, Float32Array]:
    """By edge, the picture of the empty clamp averaged along it, shape (h, w) [grey levels]."""
    exact = clamp.picture.astype(np.float32)
    return {HINGE: cv2.blur(exact, (1, _ALONG)), BOTTOM: cv2.blur(exact, (_ALONG, 1))}


def _places(
    view: FaceView, edge: str, pose: FloatArray, moved: PictureShift | None
) -> tuple[Float32Array, Float32Array]:
    """Pixels u and v of n places along an edge and m across it, a pixel apart, inwards; (n, m) each."""
    along = np.arange(_FROM_CORNER, view.length(edge) - _FROM_CORNER, _PITCH)
    line = view.line(edge, pose, along)
    outer, inner = view.line(BOTTOM if edge == HINGE else HINGE, pose, np.array([0.0, view.pixel]))
    here = view.pixels(line).astype(np.float32)
    inwards = view.pixels(line + inner - outer).astype(np.float32) - here
    if moved is not None:
        here += moved.at(here.astype(float)).astype(np.float32)
    number = round(_REACH / view.pixel)
    across = np.arange(-number, number + 1, dtype=np.float32)
    u, v = (here[:, i : i + 1] + across * inwards[:, i : i + 1] for i in (0, 1))
    return u, v


def _steps(smooth: Float32Array, u: Float32Array, v: Float32Array) -> Float32Array:
    """Brightness inside minus that outside [grey levels] at places (n, m) [px]; (n, m - 2 _SIDE - 2 _GAP)."""
    grey = cv2.remap(smooth, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    side = cv2.blur(grey, (_SIDE, 1), anchor=(0, 0))
    last = side.shape[1] - _SIDE + 1  # beyond, the average runs out of the row
    apart = _SIDE + 2 * _GAP + 1
    steps: Float32Array = side[:, apart:last] - side[:, : last - apart]
    return steps


def line_strength(
    clamp: EmptyClamp, seen: FaceView, edge: str, pose: FloatArray, moved: PictureShift | None = None
) -> float:
    """How much a line stands out in the empty clamp where an edge of a door is.

    Args:
        clamp: The empty clamp.
        seen: Its camera before the face.
        edge: "hinge" or "bottom".
        pose: y, z [m] and rotation [rad] of the door, shape (3,).
        moved: From a place in the door's picture to that in the empty clamp; None where it is the same.

    Returns:
        The step of the strongest line there, as a multiple of what is usual beside it; as large as that of a border
        between two surfaces that are equally bright in the mean but not in their texture.
    """
    steps = _steps(smoothed(clamp)[edge], *_places(seen, edge, pose, moved))
    offset = np.abs(np.arange(steps.shape[1]) - steps.shape[1] // 2) * seen.pixel
    near, usual = np.flatnonzero(offset < _NEAR), np.flatnonzero(offset >= _NEAR)[::_APART]
    there = offset[near] <= MOVED
    most = 0.0
    for count in _AVERAGED:
        size = np.abs(steps if count == 1 else cv2.blur(steps, (1, count)))
        found = row_medians(size[:, near].T)
        if found[there].max() >= found.max():  # else it is the flank of a line further off
            most = max(most, float(found.max()) / max(median(size[:, usual]), _FAINTEST))
    return most


def has_line(
    clamp: EmptyClamp, seen: FaceView, edge: str, pose: FloatArray, moved: PictureShift | None = None
) -> bool:
    """Whether the empty clamp has a line where an edge of a door is, or is by what moved; see `line_strength`."""
    return line_strength(clamp, seen, edge, pose) > _PLAIN or (
        moved is not None and line_strength(clamp, seen, edge, pose, moved) > _PLAIN
    )


def _patch(picture: ByteArray, corners: FloatArray, size: tuple[int, int]) -> Float32Array:
    """Part of a picture between four pixels u, v (4, 2), as `size` columns and rows [grey levels]."""
    width, height = size
    target = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]], dtype=np.float32)
    warp = cv2.getPerspectiveTransform(corners.astype(np.float32), target)
    patch: Float32Array = cv2.warpPerspective(picture, warp, size, borderMode=cv2.BORDER_REPLICATE).astype(
        np.float32
    )
    return patch


def _pattern(patch: Float32Array) -> FloatArray:
    """Brightness about that nearby, relative, of a patch of any size; flat. Light changes it little, and noise."""
    fine, coarse = (cv2.blur(patch, (side, side)) for side in (_FINE, _COARSE))
    pattern = (fine / cv2.max(coarse, 1.0))[_FINE:-_FINE:_FINE, _FINE:-_FINE:_FINE].ravel().astype(
        float
    ) - 1.0
    # What stands out far, as dust and tools that came or went, must not decide.
    most = _CLIPPED * median(np.abs(pattern))
    clipped: FloatArray = np.clip(pattern, -most, most)
    return clipped


@dataclass(frozen=True, eq=False)
class FaceInClamp:
    """The place of a face in a picture and in that of the empty clamp.

    Attributes:
        picture: Grey picture, shape (h, w), uint8.
        view: Its camera before the face.
        clamp: The empty clamp.
        seen: Its camera before the face.
        pose: y, z [m] and rotation [rad] of the door, shape (3,).
        fit: What the background says of the picture of the empty clamp; None where it says nothing.
    """

    picture: ByteArray
    view: FaceView
    clamp: EmptyClamp
    seen: FaceView
    pose: FloatArray
    fit: ClampFit | None = None

    @property
    def moved(self) -> PictureShift | None:
        """From a place in the picture to that in the empty clamp; None where it is the same or not known."""
        return None if self.fit is None else self.fit.displacement

    @property
    def stale(self) -> str:
        """What no longer fits, as the end of a sentence; empty where all does."""
        return f"; {self.fit.sentence}" if self.fit is not None and self.fit.stale else ""

    def _patches(self, sample: float, moved: PictureShift | None = None) -> tuple[Float32Array, Float32Array]:
        """That place in both pictures, read at points that far apart [m]."""
        sides = [min(_LARGEST, self.view.length(edge) - 2 * _INSIDE) for edge in (BOTTOM, HINGE)]
        y, z = (
            self.view.line(edge, self.pose, np.array([_INSIDE, _INSIDE + side])) - self.pose[:2]
            for edge, side in zip((BOTTOM, HINGE), sides, strict=True)
        )
        corners = self.pose[:2] + np.stack([y[0] + z[0], y[1] + z[0], y[1] + z[1], y[0] + z[1]])
        size = int(sides[0] / sample), int(sides[1] / sample)
        there = self.seen.pixels(corners)
        if moved is not None:
            there = there + moved.at(there)
        return _patch(self.picture, self.view.pixels(corners), size), _patch(self.clamp.picture, there, size)

    def as_bright(self) -> bool:
        """Whether light and shadows can make what differs in brightness, or another light that the background shows."""
        bright, before = (
            max(float(patch.mean()), 1.0) for patch in self._patches(_BRIGHT_SAMPLE, self.moved)
        )
        lights = [1.0]
        if self.fit is not None:
            lights.append(float(self.fit.background.light[1]))
        return any(1.0 / _AS_BRIGHT < bright / before / light < _AS_BRIGHT for light in lights)

    def likeness(self) -> float:
        """Correlation of the two patterns, where the empty clamp was or where it is by what moved: the larger one."""
        moved = self.moved
        here = self._likeness(None)
        return here if moved is None else max(here, self._likeness(moved))

    def _likeness(self, moved: PictureShift | None) -> float:
        one, two = (_pattern(patch) for patch in self._patches(_SAMPLE, moved))
        size = float(np.sqrt((one @ one) * (two @ two)))
        return float(one @ two) / size if size else 0.0


def check_clamp(face: FaceInClamp) -> None:
    """Whether what was found is no part of the empty clamp.

    Args:
        face: Where it was found.

    Raises:
        NoDoor: The face is the empty clamp.
        WrongEdge: A line taken for an edge is the empty clamp's.
    """
    view, pose = face.view, face.pose
    lines = [edge for edge in EDGES if has_line(face.clamp, face.seen, edge, pose, face.moved)]

    def marks() -> tuple[tuple[str, FloatArray], ...]:
        places = {edge: np.linspace(0.0, view.length(edge), 9) for edge in lines or EDGES}
        return tuple((edge, view.pixels(view.line(edge, pose, along))) for edge, along in places.items())

    if len(lines) != 1 and face.as_bright() and (lines or face.likeness() > _ALIKE):
        raise NoDoor(
            "no door stands there: the picture is as of the empty clamp, and what looks like the corner of a door is "
            "the clamp's own; put the door in, clear the view of its edges, or take the picture of the empty clamp "
            f"again if that has changed (calibrate empty){face.stale}",
            marks=marks(),
        )
    if lines:
        raise WrongEdge(
            f"the line taken for the {' and for the '.join(lines)} edge is at the same place in the picture of the "
            "empty clamp: it is the border of a jaw, a rail or a plate, or one lies exactly before or behind the edge; "
            "clear the view of the edge, or take the picture of the empty clamp again if that has changed (calibrate "
            f"empty){face.stale}",
            edge=lines[0],
            marks=marks(),
        )
