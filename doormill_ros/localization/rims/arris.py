"""A burnt or rounded arris that looks like softness: narrower than two pixels, or nearly as dark as the background.

The mean profile of an edge has 800 rows, so differences of a thousandth of the step are seen in it once the texture
beside the edge is taken for what it is: errors that go together. Two steps must then explain it better than all that
spreads one step evenly - a lens, a disc of confusion, fibres - for these leave a profile that is the same from both
ends.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.linalg.lapack import dgeqrf, dtrtri

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.blur import Spread, bin_places, profile_covariance
from doormill_ros.localization.edge_points.step_grid import nearness
from doormill_ros.localization.edge_points.step_models import blurred_step
from doormill_ros.localization.edge_points.texture import Variograms
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.rims.processing import mirrored
from doormill_ros.localization.rims.rim import EVEN, NARROW, Rim
from doormill_ros.localization.rims.step_fits import (
    Sharp,
    StepFit,
    fit_one,
    fit_ramp,
    fit_soft_disc,
    fit_two,
)
from doormill_ros.units import m_to_mm

# What is left of a point spread once lens, disc and fibres were tried, as a share of the step.
_MODEL = 1.0e-3
_SLOPE = 1.0e-2  # change of light and texture over half a window, as a share of the step
# Squared deviations by which two steps must fit better: of 1064 edges without a rim, in seven ways of rounding, 18 had
# more than 2 and none 4.6; with a rim about as dark as the background, which texture makes, none 3.
_GAIN, _GAIN_DARK, _AS_BACKGROUND = 6.0, 10.0, 0.05
HINT = 3.0  #: of some rows of an edge; then all are looked at
_ROUNDED, _LEVELS = 0.3, 1.0  # error of rounding, and after how many it is another one [grey levels]
_WITHIN = 0.29  # spread of the pixels in a bin, in bins
_NEAR = 4.0  # px; within that the profile rises
_STARTS = 3  # of the starts, the best
_FREE = 6  # parameters of two steps
_LIGHTEST = 0.6  # share of the step at the outer border: a lighter rim moves the line by little
_LEAST_SHIFT = 0.5  # px
_WIDTHS = (1.2, 2.2, 3.6)  # px
_KINDS = (0.5, 0.85), (1.0, 1.0)  # outer border as a share of the width, sharpness as a share of the blur
_POLISHED = (-0.2, 1.8, 1.15)  # shift, width and sharpness of a bright rim, as shares of the blur
_TRIED = np.array([-1.5, 1.5, 2.5, 3.5, 4.5])  # px; where steps beside the edge would show a rim
_CERTAIN = 9.0  # squared deviations between two readings of which one can be left out
_SAME = 0.05  # by how much two edges differ in blur, as a share
_AS_WIDE = np.array([0.8, 0.9, 1.0, 1.1, 1.2])  # by what factors rims of two edges differ in width
_AS_DARK = 0.02  # and in brightness, as a share of the step
_BLURS = np.array([0.95, 1.0, 1.05, 1.1])
_SHIFTS = np.arange(-2.0, 6.0, 0.1)  # px


class Profile:
    """The mean profile of an edge, its errors made white.

    Attributes:
        spread: The profile.
        whiten: What makes its errors white, shape (m, m).
    """

    def __init__(self, spread: Spread, step: float, inside: Variograms, outside: Variograms) -> None:
        """Weigh a profile of `step` grey levels by the textures of face and background."""
        place = bin_places(spread.mean.size)
        covariance = profile_covariance(spread, step, inside, outside, _MODEL)
        covariance += _slopes(place.size)
        self.spread = spread
        self.mean = spread.at_middles()
        covariance += _rounding(self.mean * step, inside, outside) / step**2
        self.whiten: FloatArray = dtrtri(np.linalg.cholesky(covariance), lower=1)[0]

    def squares(self, fit: StepFit) -> float:
        """Sum of the squared deviations that a fit leaves."""
        return fit.misfit**2 * self.mean.size

    def _both_ends(self) -> float:
        """Sum of the squared deviations from the best step that is alike from both ends."""
        return float(np.sum(np.square(self.whiten @ mirrored(self.mean, self.whiten).rest)))

    def odd(self, least: float = _GAIN) -> bool:
        """Whether steps beside the edge could explain `least` squared deviations; few profiles need be fitted."""
        place, blur = bin_places(self.mean.size), self.spread.blur
        near = 0.1 * blur
        step, wider = blurred_step(place, blur), blurred_step(place, blur + near)
        plain = np.array((np.ones_like(place), step, blurred_step(place - near, blur), wider))
        rims = blurred_step(place - _TRIED[:, None], blur)
        # The last column of the triangular factor is the profile in the basis of those before it.
        columns = self.whiten @ np.vstack((plain, rims, self.mean)).T
        triangle, *_ = dgeqrf(columns)
        beyond = triangle[len(plain) : columns.shape[1] - 1, -1]
        return bool(beyond @ beyond > least)

    def find(self, pixel: float) -> Rim | None:
        """The dark rim that the profile shows, or None; `pixel` is the size of one on the face [m]."""
        if not self.odd():
            return None
        mean, whiten, blur = self.mean, self.whiten, self.spread.blur
        # Half as dark as the background a rim softens the edge, as dark as it the line lies at its inner border.
        starts = np.array([(part * width, width, soft * blur) for part, soft in _KINDS for width in _WIDTHS])
        order = np.argsort(nearness(mean, whiten, starts), kind="stable")
        tries = [fit_two(mean, whiten, start) for start in starts[order[:_STARTS]]]
        rims = [fit for fit in tries if _arris(fit, pixel)]
        if not rims:
            return None
        best = self._surely(min(rims, key=self.squares))
        rim = self._rim(best)
        if _polish(best):
            return rim
        least = _GAIN if rim.brightness + 1 > _AS_BACKGROUND else _GAIN_DARK
        least = least * max(self._left_near(best), 1.0) + self.squares(best)
        # What is left of chips trails behind an edge that stays where it is.
        if any(self.squares(fit) <= least for fit in tries if _trail(fit)):
            return None
        # A camera that sharpens or smooths does it on both sides.
        if abs(rim.brightness + 0.5) > EVEN and self._both_ends() <= least:
            return None
        # Of what spreads one step evenly, one that is as good is enough, so the cheapest comes first.
        if self.squares(fit_one(mean, whiten, blur)) <= least:
            return None
        spreads = (fit(mean, whiten, 1.2 * blur, 0.6 * blur) for fit in (fit_soft_disc, fit_ramp))
        return None if any(self.squares(fit) <= least for fit in spreads) else rim

    def _left_near(self, fit: StepFit) -> float:
        """Mean square that two steps leave where the profile rises, 1 as its errors are known.

        It is more where pixels are made up of their neighbours, as those of a Bayer pattern are.
        """
        place = bin_places(self.mean.size)
        shift, width, blur = fit.places
        steps = np.stack([blurred_step(place - shift, blur), blurred_step(place - shift + width, blur)])
        rest = self.mean - fit.heights @ steps
        near = np.abs(place) < _NEAR
        left = self.whiten @ (rest - rest.mean())
        return float(left[near] @ left[near] / (np.count_nonzero(near) - _FREE))

    def placed(self, rim: Rim, pixel: float) -> Rim:
        """A narrow dark rim that was found, placed anew with the errors' correlation taken into account."""
        fit = self._surely(fit_two(self.mean, self.whiten, np.array([rim.shift, rim.width, rim.blur])))
        return self._rim(fit) if _polish(fit) or _arris(fit, pixel) else rim

    def _surely(self, dark: StepFit) -> StepFit:
        """Two steps with a dark rim between them, or those with a bright one where that explains more for certain.

        A bright rim hardly wider than a pixel steepens the edge as a dark one does through a lens too sharp to be true.
        """
        bright = fit_two(self.mean, self.whiten, np.array(_POLISHED) * self.spread.blur)
        better = self.squares(dark) - self.squares(bright) > _CERTAIN
        return bright if better and _polish(bright) else dark

    def like(self, edge: str, rim: Rim, pixel: float) -> Rim:
        """The rim of this edge, which has one like that of the other.

        Args:
            edge: "hinge" or "bottom".
            rim: Of the other edge.
            pixel: Size of one on the face [m].

        Raises:
            WrongEdge: It has none, or that cannot be told.
        """
        none, same, start = self._compared(rim)
        if same - none > _CERTAIN:
            raise WrongEdge(
                f"a dark rim of {m_to_mm(rim.width * pixel):.2f} mm lies along one edge and none along the {edge} "
                "edge: what the saw has burnt, or the brim of something behind the door; clean the edges or clear "
                "what stands behind",
                edge=edge,
            )
        if none - same > _CERTAIN:
            sharp = Sharp(rim.blur, _SAME * rim.blur)
            return self._rim(fit_two(self.mean, self.whiten, start, sharp))
        raise WrongEdge(
            f"along the other edge lies a dark rim of {m_to_mm(rim.width * pixel):.2f} mm, and the {edge} edge does "
            "not tell whether one lies along it, too; clean the edges or put a lighter surface behind the door",
            edge=edge,
        )

    def _compared(self, rim: Rim) -> tuple[float, float, FloatArray]:
        """Squared deviations without a rim and with one like `rim`, and that one's shift, width and blur (3,) [px]."""
        place = bin_places(self.mean.size)
        grid = np.meshgrid(_SHIFTS, rim.width * _AS_WIDE, rim.blur * _BLURS, indexing="ij")
        tried = np.stack(grid, axis=-1).reshape(-1, 3)
        level = self.whiten @ np.ones(place.size)
        level /= np.linalg.norm(level)

        def white(profiles: FloatArray) -> FloatArray:
            """Without the level, which is free."""
            seen = profiles @ self.whiten.T
            free: FloatArray = seen - np.multiply.outer(seen @ level, level)
            return free

        profile = white(self.mean)
        outer = white(blurred_step(place - tried[:, :1], tried[:, 2:]))
        inner = white(blurred_step(place - tried[:, :1] + tried[:, 1:2], tried[:, 2:]))
        one, two = outer @ profile, inner @ profile
        total = float(profile @ profile)
        square = np.einsum("gm,gm->g", outer, outer)
        none = total - float(np.max(one**2 / square))
        # The outer step is a share of both, which is known beforehand, if not better than to _AS_DARK.
        share = (-rim.brightness / _AS_DARK, -(1.0 + rim.brightness) / _AS_DARK)
        square = square + share[0] ** 2
        both = np.einsum("gm,gm->g", outer, inner) + share[0] * share[1]
        other = np.einsum("gm,gm->g", inner, inner) + share[1] ** 2
        explained = (other * one**2 - 2 * both * one * two + square * two**2) / (square * other - both**2)
        best = int(np.argmax(explained))
        return none, total - float(explained[best]), tried[best]

    def _rim(self, fit: StepFit) -> Rim:
        shift, width, blur = (float(v) for v in fit.places)
        dark = float(fit.heights[1] / fit.heights.sum())
        scale = max(fit.misfit, 1.0)
        return Rim(shift, fit.deviation * scale, width, -dark, blur, fit.misfit * self.spread.level)


@lru_cache(maxsize=16)
def _slopes(size: int) -> FloatArray:
    """Covariance (m, m) of what a change of light or texture on either side does to a profile of `size` bins."""
    place = bin_places(size) * (_SLOPE / bin_places(size)[-1])
    inside, outside = np.minimum(place, 0.0), np.maximum(place, 0.0)
    covariance: FloatArray = np.outer(inside, inside) + np.outer(outside, outside)
    return covariance


def _rounding(grey: FloatArray, inside: Variograms, outside: Variograms) -> FloatArray:
    """Covariance (m, m) of what rounding to whole grey levels, once or more often, does to a profile (m,) of them.

    It is an error that depends on the grey level and returns after a level or a few. Where rows differ by more, by
    their noise or as the edge is steep, it averages out.
    """
    low, high = float(grey.min()), float(grey.max())
    share = (grey - low) / max(high - low, 1.0)
    out = 1.0 - share if grey[0] > grey[-1] else share
    noise = (1.0 - out) * inside.rows[1] + out * outside.rows[1]
    apart = noise + np.square(_WITHIN * np.gradient(grey))
    reach = (_LEVELS**2 + apart)[:, None] + apart
    covariance: FloatArray = grey[:, None] - grey
    covariance *= covariance
    covariance /= -2.0 * reach
    np.exp(covariance, out=covariance)
    covariance *= _ROUNDED**2 * _LEVELS / np.sqrt(reach)
    return covariance


def _trail(fit: StepFit) -> bool:
    """Whether two fitted steps are an edge and a faint trail inside of it."""
    part = float(fit.heights[0] / fit.heights.sum())
    return bool(fit.places[1] > _WIDTHS[1] and _LIGHTEST < part < 1.0)


def _polish(fit: StepFit) -> bool:
    """Whether two fitted steps can be the borders of a bright arris."""
    _, width, blur = fit.places
    total = float(fit.heights.sum())
    return bool(min(width, blur) > 0 and total > 0 and fit.heights[0] > total)


def _arris(fit: StepFit, pixel: float) -> bool:
    """Whether two fitted steps can be the borders of a dark arris."""
    shift, width, blur = fit.places
    total = float(fit.heights.sum())
    if min(width, blur) <= 0 or width * pixel > NARROW or shift < _LEAST_SHIFT or total <= 0:
        return False
    return bool(-0.1 < fit.heights[0] / total < _LIGHTEST)
