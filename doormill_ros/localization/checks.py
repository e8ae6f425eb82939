"""Reasons to refuse a picture or what was found in it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray, IntArray
from doormill_ros.cell.places.layout import CAMERA_SLACK, DoorOffset, PlacementLimits
from doormill_ros.cell.run.clock import FUTURE
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.edge_points.blur import Spread
from doormill_ros.localization.edge_points.profiles import WHITE, Profiles
from doormill_ros.localization.errors import (
    BadCameraInfo,
    BadDoorFace,
    BadPicture,
    Blurred,
    CameraInfoMissing,
    CameraInfoSize,
    NoEdge,
    OutOfRange,
    OverExposed,
    StalePicture,
    TooFewInliers,
    UnderExposed,
    WrongEdge,
)
from doormill_ros.localization.lines.fit import LESS_SQUARE, CornerFit, LineFit
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.statistics import share
from doormill_ros.units import m_to_mm, rad_to_deg

_MOST_WHITE = 0.6  # share of clipped pixels in a picture
_DARKEST = 16  # grey level that one pixel in two hundred must exceed
_FEWEST_ROWS = 60
#: Of a door's face [m]; a recipe has narrower limits, a message may hold anything.
WIDTHS, THICKNESSES = (0.1, 3.0), (0.005, 0.2)
#: Of a pixel on the door's face [m]: finer ones ask for more memory than there is, coarser ones show no edge.
PIXELS = (2e-5, 2e-3)
_STREAKY = 0.05  # streaks from which a line along one may be taken for a line along the edge
_SKEW = 3.0  # standard deviations of the measurement by which an angle may exceed the tolerance
# Misfit of the mean profile from one blurred step that makes it two edges: as a share of the step, as
# a multiple of the rows' scatter, and of the streaks of wood grain beside the edge.
_DOUBLE, _DOUBLE_SCATTER, _DOUBLE_STREAKS = 0.02, 3.5, 2.0


def check_input(
    picture: ByteArray, camera: CameraModel | None, age: float, settings: LocalizerSettings
) -> None:
    """Whether the picture is one, shape (h, w) and uint8, is new by its `age` [s] and belongs to the camera info.

    Raises:
        LocalizationError: BadPicture, CameraInfoMissing, CameraInfoSize or StalePicture.
    """
    if not isinstance(picture, np.ndarray) or picture.ndim != 2 or picture.dtype != np.uint8:
        found = f"shape {np.shape(picture)} and type {getattr(picture, 'dtype', type(picture).__name__)}"
        raise BadPicture(f"the picture has {found}, allowed is (h, w) uint8; set the camera to 8 bit grey")
    if camera is None:
        raise CameraInfoMissing(
            "no camera info came with the picture; start the camera's driver with its calibration"
        )
    check_size(picture.shape[::-1], camera)
    if age < -FUTURE:
        raise StalePicture(
            f"the picture's stamp is {-age:.2f} s in the future; set the clocks of camera and PC", age=age
        )
    if not age <= settings.max_age:
        raise StalePicture(
            f"the picture is {age:.2f} s old, allowed are {settings.max_age:.2f} s; take a new one", age=age
        )


def check_size(size: tuple[int, ...], camera: CameraModel) -> None:
    """Whether a picture of that width and height [px] belongs to the camera info.

    Raises:
        CameraInfoSize: It does not.
    """
    if size != camera.size:
        raise CameraInfoSize(
            f"the camera info is for {camera.size[0]} x {camera.size[1]} px, the picture has {size[0]} x {size[1]} px; "
            "set the camera to the size it was calibrated with",
            info=camera.size,
            picture=size,
        )


def check_face(width: float, thickness: float) -> None:
    """Whether a face of that size [m] can be a door's.

    Raises:
        BadDoorFace: It cannot.
    """
    for name, value, (low, high) in (("width", width, WIDTHS), ("thickness", thickness, THICKNESSES)):
        if not low <= value <= high:
            raise BadDoorFace(
                f"the door's {name} is {value:g} m, allowed is {low:g} to {high:g} m; correct the recipe"
            )


def check_view(pixel: float) -> None:
    """Whether a camera with pixels of that size on the face [m] can see an edge.

    Raises:
        BadCameraInfo: It cannot.
    """
    low, high = PIXELS
    if not low <= pixel <= high:
        raise BadCameraInfo(
            f"by the camera info a pixel is {m_to_mm(pixel):g} mm on the door, allowed is {m_to_mm(low):g} to "
            f"{m_to_mm(high):g} mm; calibrate the camera again"
        )


def check_exposure(counts: IntArray, strict: bool = False) -> None:
    """Whether a picture is neither black nor white, by its `level_counts`; `strict` when no edge was found in it.

    Raises:
        LocalizationError: UnderExposed or OverExposed.
    """
    shares = np.cumsum(counts) / counts.sum()
    white = float(1 - shares[WHITE - 1])
    most = 0.15 if strict else _MOST_WHITE
    if white > most:
        raise OverExposed(
            f"{100 * white:.0f} % of the picture are clipped at white, allowed are {100 * most:.0f} %; "
            "shorten the exposure or dim the light",
            share=white,
        )
    bright = int(np.searchsorted(shares, 0.995))
    darkest = 2 * _DARKEST if strict else _DARKEST
    if bright < darkest:
        raise UnderExposed(
            f"the brightest parts of the picture have grey level {bright}, at least {darkest} is needed; "
            "lengthen the exposure or switch on the light",
            level=bright,
        )


def check_rows(profiles: Profiles, settings: LocalizerSettings) -> None:
    """Whether enough rows of an edge show a step.

    Raises:
        LocalizationError: NoEdge, OverExposed or TooFewInliers.
    """
    count = len(profiles.lines)
    if count < _FEWEST_ROWS:
        raise NoEdge(
            f"only {count} px of the {profiles.edge} edge are in the picture, {_FEWEST_ROWS} are needed; "
            "check the slider and the door's size in the recipe",
            edge=profiles.edge,
        )
    clipped = share(profiles.clipped)
    if clipped > settings.min_inlier_share:
        raise OverExposed(
            f"{100 * clipped:.0f} % of the {profiles.edge} edge are clipped at white, allowed are "
            f"{100 * settings.min_inlier_share:.0f} %; shorten the exposure or dim the light",
            edge=profiles.edge,
        )
    check_share(profiles.edge, share(profiles.edge_like), settings)


def check_share(edge: str, found: float, settings: LocalizerSettings) -> None:
    """Whether enough of an edge agrees with its line.

    Raises:
        TooFewInliers: It does not.
    """
    if found < settings.min_inlier_share:
        raise TooFewInliers(
            f"{100 * found:.0f} % of the {edge} edge agree with a line, at least "
            f"{100 * settings.min_inlier_share:.0f} % are needed; clear the edge of dust and tools or turn the door",
            edge=edge,
            share=found,
        )


def allowed_misfit(spread: Spread, streaks: float) -> float:
    """Largest misfit of one edge's mean profile; see `check_spread`."""
    return max(_DOUBLE, _DOUBLE_SCATTER * spread.level, _DOUBLE_STREAKS * streaks)


def check_spread(edge: str, spread: Spread, streaks: float, settings: LocalizerSettings) -> None:
    """Whether an edge is sharp, and one.

    Args:
        edge: "hinge" or "bottom".
        spread: Its blur.
        streaks: Standard deviation of the streaks beside it, as a share of the step.
        settings: Limits of refusal.

    Raises:
        LocalizationError: Blurred or WrongEdge.
    """
    if spread.blur > settings.max_blur:
        raise Blurred(
            f"the {edge} edge is {spread.blur:.1f} px soft, allowed are {settings.max_blur:.1f} px; "
            "focus the camera, clean its window, hold the door still, or clear the edge of shadows and rims",
            edge=edge,
            blur=spread.blur,
        )
    allowed = allowed_misfit(spread, streaks)
    if spread.misfit > allowed:
        raise WrongEdge(
            f"the {edge} edge is not one step from face to background: {100 * spread.misfit:.0f} % of it do not "
            f"fit, allowed are {100 * allowed:.0f} %; another edge or a shadow lies beside it, change the light",
            edge=edge,
            misfit=spread.misfit,
        )


def edge_in_edge() -> WrongEdge:
    """The refusal of a picture in which the edge of the face cannot be told from those beside it."""
    return WrongEdge(
        "several steps run side by side where an edge of the face must be, and which of them is the face's cannot "
        "be told; change the light or clear the view of the door's corner"
    )


def check_square(fit: CornerFit, streaks: dict[str, float], settings: LocalizerSettings) -> None:
    """Whether the two lines stand at a right angle within the tolerance of doors.

    Args:
        fit: The corner.
        streaks: Beside each edge, standard deviation as a share of its step.
        settings: Limits of refusal.

    Raises:
        WrongEdge: They do not.
    """
    edge = max(streaks, key=lambda name: streaks[name])
    usual = _SKEW * (LESS_SQUARE * settings.squareness + fit.square_deviation)
    if streaks[edge] > _STREAKY and abs(fit.out_of_square) > usual:
        raise WrongEdge(
            f"the lines found are {rad_to_deg(fit.out_of_square):+.3f} degrees out of square, and streaks of "
            f"{100 * streaks[edge]:.0f} % of the step run beside the {edge} edge: the door is not square, or a streak "
            "stands in for a part of its edge; put a background behind the door from which all of its grain stands out",
            edge=edge,
            out_of_square=fit.out_of_square,
        )
    allowed = settings.squareness_limit + _SKEW * fit.square_deviation
    if abs(fit.out_of_square) > allowed:
        raise WrongEdge(
            f"the lines found are {rad_to_deg(fit.out_of_square):+.3f} degrees out of square, allowed are "
            f"{rad_to_deg(allowed):.3f}; one of them is not an edge of the door, or the door is not square",
            out_of_square=fit.out_of_square,
        )


def check_range(offset: DoorOffset, limits: PlacementLimits, sure: bool = True) -> None:
    """Whether the door stands where the cell accepts it; not `sure` where only a corner shows that may be another.

    Raises:
        OutOfRange: It does not.
    """
    if limits.beyond(offset, CAMERA_SLACK):
        found = "the door stands" if sure else "the outermost corner that shows seems to stand"
        act = (
            "place it again"
            if sure
            else "place the door again, or clear what covers its edges if it stands right"
        )
        raise OutOfRange(
            f"{found} {m_to_mm(offset.y):+.2f} mm in y, {m_to_mm(offset.z):+.2f} mm in z and "
            f"{rad_to_deg(offset.rotation):+.2f} degrees off, allowed are {m_to_mm(limits.y):.0f} mm, "
            f"{m_to_mm(limits.z):.0f} mm and {rad_to_deg(limits.rotation):.0f} degrees; {act}",
            offset=offset,
        )


def check_certainty(
    covariance: FloatArray, hinge: LineFit, bottom: LineFit, settings: LocalizerSettings
) -> None:
    """Whether the pose is known well enough by its covariance, shape (3, 3) [m, m, rad].

    Raises:
        TooFewInliers: It is not.
    """
    deviation = np.sqrt(np.diag(covariance))
    if np.any(deviation > settings.max_deviation):
        allowed = settings.max_deviation
        scatter = m_to_mm(max(hinge.scatter, bottom.scatter))
        raise TooFewInliers(
            f"the pose is uncertain by {m_to_mm(deviation[0]):.3f} mm, {m_to_mm(deviation[1]):.3f} mm and "
            f"{rad_to_deg(deviation[2]):.3f} degrees, allowed are {m_to_mm(allowed[0]):.3f} mm, "
            f"{m_to_mm(allowed[1]):.3f} mm and {rad_to_deg(allowed[2]):.3f} degrees; the edges scatter by "
            f"{scatter:.3f} mm, clean them",
            deviation=deviation,
        )
