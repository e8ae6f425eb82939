"""Whether both edges are as sharp as one lens shows them: one that is much softer than the other is no single step.

Rows of grain, of a second door or of a rim that were read as one step scatter between its borders. The softness they
leave tells, and where they follow one border first and another later, so does the angle between the lines.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import sqrt

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.lines.fit import CornerFit
from doormill_ros.localization.rims.rim import PLACED
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.units import m_to_mm, rad_to_deg

#: An edge softer than the other by that factor is none; of edges that were true the largest was 1.46
APART = 1.6
_UNLIKE = 1.12  #: from that factor on an angle between the lines has to be that of a well made door
_SKEW = 3.0  #: standard deviations by which it may exceed that
_FINEST = 0.3  #: blurs below that are not told apart [px]
_SAME = 0.04  #: by how much two edges that one lens sees differ in blur, as a share
_SURELY = 2.0  #: standard deviations of either blur by which they differ more


def check_sharpness(
    blurs: Mapping[str, float],
    view: FaceView,
    fit: CornerFit,
    drawn: Callable[[str], FloatArray],
    settings: LocalizerSettings,
) -> None:
    """Whether the edges are alike.

    Args:
        blurs: Standard deviation of the point spread of each edge [px].
        view: The camera before the face.
        fit: The corner.
        drawn: Pixels along an edge, shape (n, 2), for the overlay.
        settings: Limits of refusal.

    Raises:
        WrongEdge: They are not, or they are a little unlike and not square either.
    """
    wide = _pixels(view)
    blurs = {edge: blur * wide[edge] for edge, blur in blurs.items()}
    softer, sharper = sorted(blurs, key=lambda name: -blurs[name])
    times = blurs[softer] / max(blurs[sharper], _FINEST)
    if times > APART:
        raise WrongEdge(
            f"the {softer} edge is {times:.1f} times as soft as the {sharper} edge, allowed are {APART:g}, as one "
            "lens sees both: what was read there is more than one step, or door or camera moved across it; clean the "
            "edge, change the light or take the picture at rest",
            edge=softer,
            marks=((softer, drawn(softer)),),
        )
    allowed = _SKEW * (settings.squareness + fit.square_deviation)
    if times > _UNLIKE and abs(fit.out_of_square) > allowed:
        raise WrongEdge(
            f"the lines found are {rad_to_deg(fit.out_of_square):+.3f} degrees out of square, allowed are "
            f"{rad_to_deg(allowed):.3f} where one edge, the {softer} one, is {times:.1f} times as soft as the other: a "
            "part of it was read along another step, or the door is not square; clean the edge or change the light",
            edge=softer,
            out_of_square=fit.out_of_square,
            marks=((softer, drawn(softer)),),
        )


@dataclass(frozen=True)
class Softness:
    """How soft an edge is.

    Attributes:
        blur: Standard deviation of its point spread [px].
        deviation: Standard deviation of that [px].
        ragged: Scatter of its edge points, which smears rows that are laid over each other [px].
    """

    blur: float
    deviation: float = 0.0
    ragged: float = 0.0


def hidden(edges: Mapping[str, Softness], view: FaceView) -> dict[str, float]:
    """By edge, how far outside of where it seems its outline may hide in its softness [px].

    One lens sees both edges. A rounded arris as dark at its outline as the background spreads the step evenly, which
    alone shows nothing of it: a slope adds a twelfth of its squared width to the variance, and its outline lies half
    that width outside of the middle of the step.

    Args:
        edges: How soft each is.
        view: The camera before the face.
    """
    wide, out = _pixels(view), {}
    for edge, own in edges.items():
        sharpest = min(
            (one.blur + _SURELY * one.deviation) * wide[name] for name, one in edges.items() if name != edge
        )
        lens = (1.0 + _SAME) * max(sharpest, _FINEST) / wide[edge]
        least = max(own.blur - _SURELY * own.deviation, 0.0)
        out[edge] = sqrt(3.0 * max(least**2 - own.ragged**2 - lens**2, 0.0))
    return out


def check_hidden(hides: Mapping[str, float], view: FaceView) -> None:
    """Whether no more of an edge hides in its softness than the border of a rim that was placed may be off.

    Args:
        hides: By edge, how far outside of it its outline may hide [px].
        view: The camera before the face.

    Raises:
        WrongEdge: One may.
    """
    for edge, reach in hides.items():
        if reach > PLACED:
            raise WrongEdge(
                f"the {edge} edge is softer than the other, as one lens sees both: the outer border of a rounded "
                f"arris may hide in it, up to {m_to_mm(reach * view.pixel):.2f} mm outside of the line; clean the "
                "edge, change the light or take the picture at rest",
                edge=edge,
            )


def _pixels(view: FaceView) -> dict[str, float]:
    """By edge, how wide a pixel across it is in angles, which one lens is as sharp in; 1 in the mean.

    A camera may send more pixels as one along one axis than along the other.
    """
    across = {HINGE: float(view.camera.k[0, 0]), BOTTOM: float(view.camera.k[1, 1])}
    mean = 0.5 * sum(across.values())
    return {edge: mean / one for edge, one in across.items()}
