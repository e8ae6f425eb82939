"""Lines through edge points, and the door's pose from two of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan, sqrt, tan

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.localization.lines.wander import EdgePieces
from doormill_ros.statistics import NORMAL_STD, median

_CUT = 4.7  # Tukey's biweight ends at that many standard deviations
_FINEST = 2.0e-7  # smallest scatter believed [m]
_CHIP = 1.0e-3  # length over which points are averaged to see chips in noise [m]
_CHIP_CUT = 6.0  # such averages lose weight from half that many standard deviations, and have none beyond
_DOUBTED = 0.1  # least weight of a point in them
LESS_SQUARE = 3.0  #: factor by which most other doors are less square than well made ones
# Shares of well made doors, of less square ones, of those that are barely milled.
_KINDS = np.array([0.55, 0.44, 0.01])


@dataclass(frozen=True, eq=False)
class LineFit:
    """A line across = place + slope (along - middle).

    Attributes:
        place: Across at the middle [m].
        slope: Across per along.
        middle: Weighted mean of along [m].
        place_variance: Of `place` [m^2].
        slope_variance: Of `slope`.
        residuals: Of all points [m], shape (n,).
        inliers: Points that agree with the line, shape (n,), bool.
        scatter: RMS residual of the inliers [m].
        bend: Half the curvature, across = ... + bend along^2 [1/m].
        bend_variance: Of `bend` [1/m^2].
        variance: That independent points would need to make the line as uncertain as it is [m^2].
        freedom: Degrees of freedom of `variance`.
    """

    place: float
    slope: float
    middle: float
    place_variance: float
    slope_variance: float
    residuals: FloatArray
    inliers: BoolArray
    scatter: float
    bend: float
    bend_variance: float
    variance: float
    freedom: float

    def moved(self, by: float, variance: float) -> LineFit:
        """This line shifted across [m], by an amount of that variance [m^2]."""
        return replace(self, place=self.place + by, place_variance=self.place_variance + variance)

    def pushed(self, place_variance: float, slope_variance: float) -> LineFit:
        """This line with the uncertainty [m^2], [-] that texture beside the edge adds."""
        return replace(
            self,
            place_variance=self.place_variance + place_variance,
            slope_variance=self.slope_variance + slope_variance,
        )


def line_products(along: FloatArray, across: FloatArray) -> FloatArray:
    """Of points, what a weighted line takes sums of: 1, along, across and the products with along; shape (5, n)."""
    products = np.empty((5, along.size))
    products[0], products[1], products[2] = 1.0, along, across
    np.multiply(along, products[1:3], out=products[3:])
    return products


def weighted_line(products: FloatArray, weight: FloatArray) -> tuple[float, float, float]:
    """Middle along, place and slope of the weighted line through points, by their `line_products`."""
    total, along, across, square, product = products.dot(weight).tolist()
    middle, place = along / total, across / total
    return middle, place, (product - middle * across) / (square - middle * along)


def fit_line(
    along: FloatArray,
    across: FloatArray,
    usable: BoolArray,
    guess: tuple[float, float],
    rounds: int = 4,
    waves: bool = True,
) -> LineFit:
    """Robust line through edge points.

    Args:
        along: Place of the points along the edge [m], shape (n,).
        across: Their place across it [m], shape (n,).
        usable: Points that may take part, at least four, shape (n,), bool.
        guess: Across at along = 0 [m], and slope.
        rounds: Rounds of reweighting, after two with least absolute distances.
        waves: Whether what lasts along it is asked for the length of its waves; a wrong lens bends edges alike.
    """
    x, y = along[usable], across[usable]
    residual = y - guess[0] - guess[1] * x
    residual -= median(residual)
    # Sums of products lose fewest digits about the middle of the points.
    origin = 0.5 * (float(x[0]) + float(x[-1])), float(y[y.size // 2])
    x, y = x - origin[0], y - origin[1]
    thin = max(x.size // 300, 1)  # a part of the points serves to find the line's neighbourhood
    every = (x, y)
    x, y, residual = x[::thin], y[::thin], residual[::thin]
    products = line_products(x, y)
    for step in range(-2, rounds):
        size = np.abs(residual)
        scale = NORMAL_STD * median(size) + _FINEST
        if step < 0:  # the guess may be off by more than the scatter: least absolute distances
            weight = np.maximum(size, scale, out=size)
            np.divide(scale, weight, out=weight)
        else:
            weight = residual / (_CUT * scale)
            weight *= weight
            np.subtract(1.0, weight, out=weight)
            np.maximum(weight, 0.0, out=weight)
            weight *= weight
            if step == rounds - 1 > 1:
                weight *= _unchipped(x, residual, weight)
        middle, place, slope = weighted_line(products, weight)
        if step == rounds - 3 and thin > 1:
            x, y = every
            products = line_products(x, y)
        residual = y - (place - slope * middle)
        residual -= slope * x
    lever = x - middle
    weighted = weight * lever
    square = np.square(lever)
    arc_middle, arc_place, arc_slope = weighted_line(line_products(lever, square), weight)
    arc = square - (arc_place - arc_slope * arc_middle) - arc_slope * lever
    stiffness = float(weight.dot(np.square(arc)))
    bend = float(weight.dot(arc * residual)) / stiffness
    if rounds > 2:
        pieces = EdgePieces(x, weight)
        for_place, for_slope = pieces.variances(residual, waves)
        freedom = pieces.freedom
        straightened = pieces.variance(residual - bend * arc)
    else:
        for_place = for_slope = straightened = scale**2
        freedom = 1.0
    total, spent = float(weight.sum()), np.square(weight)
    middle, place = middle + origin[0], place + origin[1]
    residuals = across - place - slope * (along - middle)
    inliers = usable & (np.abs(residuals) < _CUT * scale)
    inliers[usable] &= weight > 0
    return LineFit(
        place,
        slope,
        middle,
        for_place * float(spent.sum()) / total**2,
        for_slope * float(weighted.dot(weighted)) / float(weighted.dot(lever)) ** 2,
        residuals,
        inliers,
        sqrt(float(weight.dot(np.square(residual))) / total),
        bend,
        straightened * float(spent.dot(np.square(arc))) / stiffness**2,
        max(for_place, for_slope),
        freedom,
    )


def _unchipped(along: FloatArray, residual: FloatArray, weight: FloatArray) -> FloatArray:
    """Weights (n,) that leave out chips too shallow to be told from noise point by point."""
    half = max(round(0.5 * _CHIP * (along.size - 1) / abs(along[-1] - along[0])), 1)
    weight = np.maximum(weight, _DOUBTED)
    sums = np.zeros((2, along.size + 2 * half + 1))  # before the first point 0, behind the last everything
    first, last = half + 1, half + 1 + along.size
    np.cumsum(weight * residual, out=sums[0, first:last])
    np.cumsum(weight, out=sums[1, first:last])
    sums[:, last:] = sums[:, last - 1 : last]
    part = sums[:, 2 * half + 1 :] - sums[:, : along.size]
    average = np.abs(part[0] / part[1])
    limit = _CHIP_CUT * (NORMAL_STD * median(average) + _FINEST)
    kept: FloatArray = np.minimum(np.maximum(2 - 2 * average / limit, 0.0), 1.0)
    return kept


def pooled(lines: dict[str, LineFit]) -> dict[str, LineFit]:
    """Lines along edges that one saw has cut, their uncertainty learned half from themselves, half from all.

    An edge of 70 mm is a dozen pieces long, from which its variance is known to a third only;
    poses that are stated too sure for that reason are the tail of the normalized errors.
    """
    freedom = sum(line.freedom for line in lines.values())
    common = sum(line.freedom * line.variance for line in lines.values()) / freedom
    out = {}
    for name, line in lines.items():
        others = freedom - line.freedom
        variance = (line.freedom * line.variance + others * common) / freedom
        # A variance that is itself uncertain: this makes normalized errors spread as they should.
        share = variance / line.variance * freedom / max(freedom - 2.0, 0.5)
        out[name] = replace(
            line,
            place_variance=share * line.place_variance,
            slope_variance=share * line.slope_variance,
            bend_variance=share * line.bend_variance,
        )
    return out


@dataclass(frozen=True, eq=False)
class CornerFit:
    """The door's pose from its two lines.

    Attributes:
        pose: y, z [m] and rotation [rad], shape (3,).
        covariance: Of the pose, shape (3, 3).
        out_of_square: Angle of the bottom edge above the normal of the hinge edge, as measured [rad].
        square_deviation: Standard deviation with which it was measured [rad].
    """

    pose: FloatArray
    covariance: FloatArray
    out_of_square: float
    square_deviation: float


def fit_corner(hinge: LineFit, bottom: LineFit, squareness: float, limit: float) -> CornerFit:
    """Join the two lines of a door that was cut at a right angle, or of one of few that were not.

    Each kind of door is worked out, and they are mixed by how probable the angle between the lines makes them.

    Args:
        hinge: y over z of the hinge edge.
        bottom: z over y of the bottom edge.
        squareness: Standard deviation of the angle between the edges of a well made door from a right angle [rad].
        limit: Largest such angle of any other; twice its standard deviation [rad].
    """
    apart = float(np.arctan(bottom.slope) + np.arctan(hinge.slope))
    read = hinge.slope_variance + bottom.slope_variance
    kinds = np.array([squareness, LESS_SQUARE * squareness, max(0.5 * limit, squareness)])
    variances = read + kinds**2
    chances = np.log(_KINDS) - 0.5 * np.log(variances) - 0.5 * apart**2 / variances
    chances = np.exp(chances - chances.max())
    chances /= chances.sum()
    pose, covariance = np.zeros(3), np.zeros((3, 3))
    poses, covariances = zip(*(_joined(hinge, bottom, float(kind)) for kind in kinds), strict=True)
    for chance, one in zip(chances, poses, strict=True):
        pose += chance * one
    for chance, one, spread in zip(chances, poses, covariances, strict=True):
        covariance += chance * (spread + np.outer(one - pose, one - pose))
    return CornerFit(pose, covariance, apart, float(np.sqrt(read)))


def crossing(hinge: LineFit, bottom: LineFit, p: float, q: float) -> tuple[float, float]:
    """Where lines of slopes p and q through the middles of two edges cross, y and z [m]."""
    a, b = hinge.place - p * hinge.middle, bottom.place - q * bottom.middle
    y = (a + p * b) / (1 - p * q)
    return y, b + q * y


def _joined(hinge: LineFit, bottom: LineFit, squareness: float) -> tuple[FloatArray, FloatArray]:
    """Pose y, z [m], rotation [rad], shape (3,), and its covariance (3, 3); doors are askew by `squareness` [rad]."""
    # Two readings of the rotation: turn, and turn + skew with skew ~ N(0, squareness^2).
    turn_h, turn_b = -atan(hinge.slope), atan(bottom.slope)
    by_hinge, by_bottom = 1 / hinge.slope_variance, 1 / bottom.slope_variance
    by_door = 1 / max(squareness, 1e-9) ** 2
    determinant = by_hinge * by_bottom + by_hinge * by_door + by_bottom * by_door
    angles = np.array([[by_bottom + by_door, -by_bottom], [-by_bottom, by_hinge + by_bottom]]) / determinant
    turn, skew = (angles @ [turn_h * by_hinge + turn_b * by_bottom, turn_b * by_bottom]).tolist()
    p, q = -tan(turn), tan(turn + skew)
    y, z = crossing(hinge, bottom, p, q)
    # Small changes: dy = d(place_h) - (z - middle_h) d(turn), dz = d(place_b) + (y - middle_b) d(turn + skew).
    lever_h, lever_b = z - hinge.middle, y - bottom.middle
    jacobian = np.array([[1, 0, -lever_h, 0], [0, 1, lever_b, lever_b], [0, 0, 1, 0]])
    states = np.zeros((4, 4))
    states[0, 0], states[1, 1], states[2:, 2:] = hinge.place_variance, bottom.place_variance, angles
    return np.array([y, z, turn]), jacobian @ states @ jacobian.T
