"""Whether both edges are as sharp as one lens shows them: one that is much softer than the other is no single step.

Rows of grain, of a second door or of a rim that were read as one step scatter between its borders. The softness they
leave tells, and where they follow one border first and another later, so does the angle between the lines.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.lines.fit import CornerFit
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.units import rad_to_deg

#: An edge softer than the other by that factor is none; of edges that were true the largest was 1.46
APART = 1.6
_UNLIKE = 1.12  #: from that factor on an angle between the lines has to be that of a well made door
_SKEW = 3.0  #: standard deviations by which it may exceed that
_FINEST = 0.3  #: blurs below that are not told apart [px]


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
    # A camera may send more pixels as one along one axis than along the other: one lens is as sharp in angles.
    across = {HINGE: view.camera.k[0, 0], BOTTOM: view.camera.k[1, 1]}
    mean = 0.5 * sum(across.values())
    blurs = {edge: float(blur * mean / across[edge]) for edge, blur in blurs.items()}
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
