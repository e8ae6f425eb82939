"""Rims along the two edges of a face: what one tells about the other, and on which side of a wide one the edge is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.ndimage import uniform_filter1d

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization import checks
from doormill_ros.localization.edge_points.blur import Spread, edge_spread
from doormill_ros.localization.edge_points.profiles import Profiles, crossed_at, measure, plain_weights
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.lines.fit import LineFit
from doormill_ros.localization.rims.arris import HINT, Profile
from doormill_ros.localization.rims.processing import check_overshoot
from doormill_ros.localization.rims.rim import (
    FAINTEST,
    Rim,
    check_alike,
    check_placed,
    check_readable,
    find_rim,
    softer,
    suspicious,
    wide_and_dark,
)
from doormill_ros.localization.rims.rounded import both_rounded, find_rounded
from doormill_ros.localization.rims.sharpness import Softness, hidden
from doormill_ros.localization.rims.step_fits import fit_one
from doormill_ros.localization.search.edge_line import EdgeLine, meet
from doormill_ros.localization.search.layers import choose
from doormill_ros.localization.search.neighbourhood import WIDE_HALF, Neighbourhood
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.view import BOTTOM, EDGES, HINGE, FaceView

_WIDE_BLUR = 3.0  # px
_AS_WIDE = 0.7
_SMOOTH = 9  # rows over which edge points are averaged; a saw's waves are longer
_RAGGED = 1.0  # px; an edge that scatters more shows no rim, and is uncertain enough to be refused for that
_OF_RIM = 0.05  # standard deviation of the blur of two steps, as a share
_ROOM = 5.0  # px: one of two steps so far apart can be read by itself


@dataclass(frozen=True, eq=False)
class EdgeRead:
    """One edge as it was read as if it were one step.

    Attributes:
        pose: Where it runs: y, z [m] and rotation [rad], shape (3,).
        profiles: Its rows.
        line: The line through their points.
        beside: What lies beside it.
    """

    pose: FloatArray
    profiles: Profiles
    line: LineFit
    beside: Neighbourhood

    @property
    def streaks(self) -> float:
        """Standard deviation of what all rows have in common beside the edge, as a share of the step."""
        return self.beside.streaks / abs(self.beside.step)


class _Seen:
    """An edge, its rim if there is one, and the mean profile over windows wide enough for it."""

    def __init__(self, picture: ByteArray, view: FaceView, read: EdgeRead) -> None:
        self.picture, self.view, self.read = picture, view, read
        self.rim: Rim | None = None
        self._wide: Spread | None = None
        self._wide_profile: Profile | None = None

    def wide(self) -> Spread:
        """The rows laid over each other in wide windows.

        Raises:
            WrongEdge: From so wide none of them looks like an edge.
        """
        if self._wide is None:
            read = self.read
            edge = read.profiles.edge
            weights = plain_weights(WIDE_HALF, _WIDE_BLUR)
            wide = measure(self.picture, self.view, edge, read.pose, weights)
            if not wide.edge_like.any():
                along = np.linspace(0.0, self.view.length(edge), 9)
                raise WrongEdge(
                    f"another step lies so near to the {edge} edge that not one row across it looks like an edge from "
                    f"{WIDE_HALF} px on each side; clean the edge or change the light",
                    edge=edge,
                    marks=((edge, self.view.pixels(self.view.line(edge, read.pose, along))),),
                )
            lines = read.profiles.lines[read.line.inliers]
            good = np.zeros(max(wide.lines[-1], lines[-1]) + 1, dtype=bool)
            good[lines] = True
            self._wide = edge_spread(wide, self._shift(wide), good[wide.lines])
        return self._wide

    def _shift(self, profiles: Profiles) -> FloatArray:
        """Where rows (n,) are laid over each other [px]: at their edge points, or waves would make steps of one."""
        read = self.read
        good, run = read.line.inliers, 0 if profiles.edge == HINGE else 1
        rows = read.profiles.lines[good]
        straight = crossed_at(self.view, profiles.edge, read.pose, np.concatenate([rows, profiles.lines]))
        waves = uniform_filter1d(read.profiles.pixels[good, run] - straight[: rows.size], _SMOOTH)
        shift = straight[rows.size :]
        shift += np.interp(profiles.lines, rows, waves) - profiles.centre
        return shift

    def _profile(self, spread: Spread) -> Profile:
        """Rows laid over each other, weighed by the textures beside the edge."""
        beside = self.read.beside
        return Profile(spread, beside.step, beside.inside, beside.outside)

    @property
    def ragged(self) -> bool:
        """Whether its points scatter too much for a rim to be seen."""
        return self.read.line.scatter > _RAGGED * self.view.pixel

    def profile(self) -> Profile:
        """That of wide windows."""
        if self._wide_profile is None:
            self._wide_profile = self._profile(self.wide())
        return self._wide_profile

    def look_closer(self) -> None:
        """Look for a dark arris where no rim was seen, and place one that was seen as well as it can be."""
        if self.ragged:
            return
        if self.rim is not None:
            if self.rim.brightness < 0 and not wide_and_dark(self.rim, self.view.pixel):
                self.rim = self.profile().placed(self.rim, self.view.pixel)
        elif self.odd:
            self.rim = self.profile().find(self.view.pixel)

    @cached_property
    def odd(self) -> bool:
        """Whether some of its rows show more than one step."""
        return self.rim is not None or self._profile(self.read.beside.spread).odd(HINT)

    @property
    def may_be_rounded(self) -> bool:
        """Whether what was found of it leaves open that its arris is rounded."""
        dark = self.rim is None or (self.rim.brightness < 0 and not wide_and_dark(self.rim, self.view.pixel))
        return dark and not self.ragged

    def look(self, sharp: float | None = None) -> None:
        """Look for a rim; see `find_rim`."""
        spread, streaks = self.read.beside.spread, self.read.streaks
        if self.ragged or (sharp is None and not suspicious(spread, streaks)):
            return
        check_overshoot(self.read.profiles.edge, self.wide(), streaks)
        rim = find_rim(self.wide(), streaks, sharp)
        single = spread.misfit < checks.allowed_misfit(spread, streaks)
        # Grain is no strip of its own.
        if rim is None or not (single and wide_and_dark(rim, self.view.pixel)):
            self.rim = rim

    def blur(self) -> float:
        """Blur of the edge, a rim taken for what it is [px]."""
        return self.read.beside.spread.blur if self.rim is None else self.rim.blur

    @property
    def crowded(self) -> bool:
        """Whether another step lies within wide windows, in which the edge looks softer than it is."""
        return any(abs(distance) < WIDE_HALF + _WIDE_BLUR for distance, _ in self.read.beside.beside)

    def softness(self) -> Softness:
        """How soft the edge is, the textures beside it taken for what they are, and a rim."""
        if self.rim is not None:
            return Softness(self.rim.blur, _OF_RIM * self.rim.blur)
        profile = self.profile()
        fit = fit_one(profile.mean, profile.whiten, profile.spread.blur)
        deviation = float(np.sqrt(fit.covariance[1, 1])) * max(fit.misfit, 1.0)
        return Softness(float(fit.places[1]), deviation, self.read.line.scatter / self.view.pixel)


@dataclass(frozen=True, eq=False)
class Border:
    """The edge of the face beside the line that was fitted as if there were one step.

    Attributes:
        shift: How far outwards of it [px].
        deviation: Standard deviation of that [px].
        spread: Of the edge, a rim taken for what it is.
        room: To another step beside it that has a side of its own [px]; infinite where there is none.
        inner: Whether it is the inner border of a rim, which then lies behind the face.
        hides: How far outside of it the outline may hide in what it is softer than the other edge [px].
    """

    shift: float
    deviation: float
    spread: Spread
    room: float = np.inf
    inner: bool = False
    hides: float = 0.0


def find_borders(
    picture: ByteArray,
    view: FaceView,
    reads: dict[str, EdgeRead],
    settings: LocalizerSettings,
    known: Mapping[str, Border] | None = None,
) -> dict[str, Border]:
    """The edges of the face, where rims lie along them or not.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        reads: By edge, what was read.
        settings: Limits of refusal.
        known: By edge, what was found when both were read as one step, if they were read again since.

    Raises:
        LocalizationError: Blurred or WrongEdge.
    """
    seen = {edge: _Seen(picture, view, read) for edge, read in reads.items()}
    for one in seen.values():
        one.look()
    sharp = min(
        (s.rim.blur for s in seen.values() if s.rim is not None and s.rim.brightness < 0), default=None
    )
    if sharp is not None:
        for one in seen.values():
            if one.rim is None and softer(one.blur(), sharp):
                one.look(sharp)
    _look_for_arrises(view, seen)
    # Read again at one of its steps an edge shows that one alone, and tells nothing any more of the other edge's.
    inner = {e: one.inner for e, one in known.items()} if known else _inside_of_rims(picture, view, seen)
    out = {}
    for edge, one in seen.items():
        read, rim = one.read, one.rim
        spread, streaks = read.beside.spread, read.beside.streaks / abs(read.profiles.step)
        if rim is None:
            # A ragged edge smears the rows laid over each other as a soft one does.
            ragged = read.line.scatter / view.pixel
            blur = float(np.sqrt(max(spread.blur**2 - ragged**2, 0.0)))
            checks.check_spread(edge, replace(spread, blur=blur), streaks, settings)
            out[edge] = Border(0.0, 0.0, spread)
        else:
            if rim.brightness < -1.0:
                check_overshoot(edge, one.wide(), streaks, rim=True)
            check_placed(edge, rim, view.pixel)
            spread = replace(one.wide(), blur=rim.blur, misfit=rim.misfit)
            checks.check_spread(edge, spread, streaks, settings)
            shift = rim.shift - (rim.width if inner[edge] or rim.gap else 0.0)
            room = rim.width if rim.width > _ROOM else np.inf
            out[edge] = Border(shift, rim.deviation, spread, room, inner[edge])
    rims, blurs = {edge: one.rim for edge, one in seen.items()}, {e: one.blur() for e, one in seen.items()}
    check_alike(rims, blurs)
    # Most edges are alike at a first glance, by which streaks make them softer than they are.
    glance = hidden({edge: Softness(blur) for edge, blur in blurs.items()}, view)
    if known or not any(glance.values()) or any(one.crowded for one in seen.values()):
        return out
    hides = hidden({edge: one.softness() for edge, one in seen.items()}, view)
    for edge, rim in rims.items():
        # A bright rim that shows softens its own edge.
        if rim is None or rim.brightness < FAINTEST:
            out[edge] = replace(out[edge], hides=hides[edge])
    return out


def _look_for_arrises(view: FaceView, seen: dict[str, _Seen]) -> None:
    """Look for dark arrises: what the saw has burnt or the plane has broken along one edge it has along both.

    Raises:
        WrongEdge: Whether there is one cannot be told.
    """
    pixel = view.pixel
    for one in seen.values():
        one.look_closer()
    _look_for_rounded(view, seen)
    for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE)):
        rim, own = seen[other].rim, seen[edge].rim
        if rim is None or rim.brightness > 0 or rim.rounded or wide_and_dark(rim, pixel) or seen[edge].ragged:
            continue
        # Streaks may make a rim of it that no lens as sharp would show.
        if own is None or (own.brightness > 0 and softer(own.blur, rim.blur)):
            seen[edge].rim = seen[edge].profile().like(edge, rim, pixel)


def _look_for_rounded(view: FaceView, seen: dict[str, _Seen]) -> None:
    """Look for rounded arrises: both edges were rounded together."""
    pixel = view.pixel
    leaves = {edge: one for edge, one in seen.items() if one.may_be_rounded}
    looks = {edge: find_rounded(one.profile(), one.rim, pixel) for edge, one in leaves.items() if one.odd}
    found = {edge: rounded for edge, rounded in looks.items() if rounded is not None}
    if found:
        profiles = {edge: one.profile() for edge, one in leaves.items()}
        for edge, rim in both_rounded(found, profiles, pixel).items():
            seen[edge].rim = rim


def _inside_of_rims(picture: ByteArray, view: FaceView, seen: dict[str, _Seen]) -> dict[str, bool]:
    """For each edge whether the edge of the face is the inner border of its rim, which then lies behind the face.

    Raises:
        WrongEdge: It cannot be told.
    """
    pixel = view.pixel
    wide = [edge for edge, one in seen.items() if one.rim is not None and wide_and_dark(one.rim, pixel)]
    inner = dict.fromkeys(seen, False)
    if not wide:
        return inner
    # What is done to one edge is done to the other, and a little narrower there.
    least = _AS_WIDE * max(one.rim.width for one in seen.values() if one.rim is not None)
    lines = {}
    for edge, one in seen.items():
        line = EdgeLine.at_pose(edge, one.read.pose, one.read.profiles.step)
        lines[edge] = [line]
        if one.rim is not None:
            outer = replace(line, across=line.across - one.rim.shift * pixel)
            within = replace(outer, across=outer.across + one.rim.width * pixel)
            lines[edge] = [within, outer] if one.rim.width > least else [outer]
            check_readable(edge, one.rim, pixel)
    layers = choose(picture, view, lines, meet(lines[HINGE][0], lines[BOTTOM][0])[:2])
    layers.check()
    return {edge: len(lines[edge]) > 1 and layers.lines[edge] is lines[edge][0] for edge in EDGES}
