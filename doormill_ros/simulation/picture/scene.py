"""What stands before the camera in a simulated picture, and the truth about it.

Lengths in metres, angles in radians. Brightness is a share of the sensor's full scale.
Nothing here is shared with the localisation: the camera file is read on its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout, DoorOffset, load_layout
from doormill_ros.config import read
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import SceneFileError
from doormill_ros.values import Array, Count, Finite, Section

FORM = "config/camera.yaml"


@dataclass(frozen=True)
class SceneMarks(Section, extra="ignore"):
    """White dots on black rings of twice their radius, in a plane across base x.

    Attributes:
        x: Of the plane [m].
        radius: Of a dot [m].
        places: y at a door width of zero and z of each dot [m].
        white: Brightness of a dot.
        black: Brightness of a ring.
    """

    x: Finite
    radius: Finite
    places: tuple[tuple[Finite, Finite], ...]
    white: Finite = 0.75
    black: Finite = 0.04


@dataclass(frozen=True, eq=False)
class SceneCamera:
    """The true camera.

    Attributes:
        matrix: Intrinsic matrix [px], shape (3, 3).
        brown: k1, k2, p1, p2, k3, shape (5,).
        shape: Rows and columns of the picture.
        origin: x, slider y and z of the projection centre in base [m], shape (3,).
        turn: Rotation of the camera from its mounting, base x ahead, base y left and base z up; shape (3, 3).
        marks: Dots of the cell beside the door; they stay where they are when the camera does not.
    """

    matrix: FloatArray
    brown: FloatArray
    shape: tuple[int, int]
    origin: FloatArray
    turn: FloatArray = field(default_factory=lambda: np.eye(3))
    marks: SceneMarks | None = None

    @staticmethod
    def load(path: Path | None = None) -> SceneCamera:
        """The camera of config/camera.yaml, taken to be true.

        Raises:
            SceneFileError: The file cannot be read, lacks a key or holds a value that cannot be.
        """
        content = read(path or resource(FORM), _CameraFile, SceneFileError, f"compare it with {FORM}")
        columns, rows = content.size
        mounting = content.mounting
        return SceneCamera(
            matrix=content.intrinsics.k,
            brown=content.distortion.coefficients,
            shape=(rows, columns),
            origin=np.array([mounting.x, mounting.slider_y, mounting.z]),
            marks=content.marks,
        )


@dataclass(frozen=True, eq=False)
class _Intrinsics(Section, extra="ignore"):
    k: Annotated[FloatArray, Array((3, 3))]


@dataclass(frozen=True, eq=False)
class _Distortion(Section, extra="ignore"):
    coefficients: Annotated[FloatArray, Array((5,))]


@dataclass(frozen=True)
class _Mounting(Section, extra="ignore"):
    x: Finite
    slider_y: Finite
    z: Finite


@dataclass(frozen=True, eq=False)
class _CameraFile(Section, extra="ignore"):
    size: tuple[Count, Count]
    intrinsics: _Intrinsics
    distortion: _Distortion
    mounting: _Mounting
    marks: SceneMarks | None = None


@dataclass(frozen=True)
class Surface:
    """A flat surface: mean brightness, and relative contrast of its fine and streaky texture.

    Attributes:
        brightness: Mean, 0..1 of full scale under unit light.
        mottle: Relative standard deviation of an isotropic texture.
        mottle_size: Its correlation length [m].
        grain: Relative standard deviation of streaks (wood grain).
        grain_width: Correlation length across the streaks [m].
        grain_angle: Direction of the streaks from the door's z axis towards -y [rad].
    """

    brightness: float
    mottle: float = 0.0
    mottle_size: float = 1.0e-3
    grain: float = 0.0
    grain_width: float = 0.8e-3
    grain_angle: float = 0.0


@dataclass(frozen=True)
class Chip:
    """Wood missing from an edge: place along it, length and depth [m]."""

    edge: str
    along: float
    length: float
    depth: float


@dataclass(frozen=True)
class Strip:
    """Part of the face along one of its edges that looks different: a lipping, an arris, a groove, dust.

    Attributes:
        edge: "hinge" or "bottom".
        start: Distance of its outer border from the edge [m].
        stop: Distance of its inner border [m].
        factor: On the brightness of the face.
        blur: Width over which the brightness changes at its borders [m].
        first: Where it begins along the edge, from the corner [m].
        last: Where it ends [m].
    """

    edge: str
    start: float
    stop: float
    factor: float
    blur: float = 5.0e-5
    first: float = -1.0
    last: float = 5.0


@dataclass(frozen=True)
class Edges:
    """How the saw left the two edges of the face.

    Attributes:
        roughness: RMS deviation from the straight line [m].
        correlation: Distance over which the roughness' autocorrelation falls to 1/e [m].
        squareness: Angle by which the bottom edge rises above the normal of the hinge edge [rad].
        softness: Half width of the fibrous rim over which the wood thins out [m].
        chips: Missing pieces.
        bow: How far the middle of each edge lies inside the line through its ends, hinge edge and bottom
            edge [m]; negative outside.
        bow_length: Length of the arc that is bowed, centred on the part in view [m].
    """

    roughness: float = 0.0
    correlation: float = 2.0e-3
    squareness: float = 0.0
    softness: float = 0.0
    chips: tuple[Chip, ...] = ()
    bow: tuple[float, float] = (0.0, 0.0)
    bow_length: float = 0.4


@dataclass(frozen=True)
class BackEdge:
    """A part of the door behind its face that sticks out beyond it: a rebate's lip, a bevel.

    Attributes:
        hinge: Overhang beyond the hinge edge [m].
        bottom: Overhang beyond the bottom edge [m].
        setback: Distance behind the face [m].
        brightness: Factor on the brightness of the face.
    """

    hinge: float
    bottom: float
    setback: float
    brightness: float


@dataclass(frozen=True)
class Shadow:
    """A half plane that gets another light; coordinates on the plane of the face, door axes.

    Attributes:
        place: A point y, z of its border [m].
        angle: Direction of the border's normal, which points into the shadow, from y towards z [rad].
        penumbra: Width over which the light changes [m].
        factor: Light inside.
        on_face: Whether it falls on the door.
        behind: Whether it falls on the background.
    """

    place: tuple[float, float]
    angle: float
    penumbra: float
    factor: float
    on_face: bool = True
    behind: bool = True


@dataclass(frozen=True)
class Blot:
    """A filled polygon before the door: dust, a clamp, part of a screw head.

    Attributes:
        outline: Corners y, z [m], door axes, shape (n, 2).
        brightness: 0..1 of full scale under unit light.
        behind: Whether it lies on the background, hidden by the door.
    """

    outline: FloatArray
    brightness: float
    behind: bool = False


@dataclass(frozen=True)
class Light:
    """Uneven light: level, and linear and quadratic change over the picture.

    Attributes:
        level: Factor on all brightness.
        gradient: Relative change from the middle to the right and lower margin.
        vignetting: Relative loss at the picture's corners.
        banding: Relative amplitude of the bands that lamps on mains draw into a rolling shutter.
        shadows: Half planes in other light.
    """

    level: float = 1.0
    gradient: tuple[float, float] = (0.0, 0.0)
    vignetting: float = 0.0
    banding: float = 0.0
    shadows: tuple[Shadow, ...] = ()


@dataclass(frozen=True)
class Sensor:
    """Point spread and noise.

    Attributes:
        blur: Standard deviation of the Gaussian point spread [px].
        defocus: Radius of the circle of confusion [px].
        read_noise: Standard deviation in the dark [grey levels of 255].
        gain: Grey levels per electron; the photon noise variance is gain times the level.
    """

    blur: float = 1.0
    defocus: float = 0.0
    read_noise: float = 1.0
    gain: float = 0.02


@dataclass(frozen=True, eq=False)
class PictureScene:
    """One picture: the true door pose and everything that makes it hard to see.

    Attributes:
        width: Door width [m].
        thickness: Door thickness [m].
        offset: The true offset from the nominal place; None for the nominal place.
        face: Face of the door.
        background: Wall of the cell behind the door.
        strips: Parts of the face that look different along its edges.
        edges: Outline of the door's face.
        back_edge: What sticks out behind the face, or None.
        light: Lighting.
        blots: Dust, clamps, screws.
        sensor: Optics and noise.
        camera: The true camera.
        layout: Where the nominal door stands.
        door: Whether a door stands there; without one all else is as it is with it.
    """

    width: float
    thickness: float
    offset: DoorOffset = field(default_factory=DoorOffset)
    face: Surface = Surface(0.65)
    background: Surface = Surface(0.18)
    strips: tuple[Strip, ...] = ()
    edges: Edges = Edges()
    back_edge: BackEdge | None = None
    light: Light = Light()
    blots: tuple[Blot, ...] = ()
    sensor: Sensor = Sensor()
    camera: SceneCamera = field(default_factory=SceneCamera.load)
    layout: CellLayout = field(default_factory=load_layout)
    door: bool = True

    @property
    def distance(self) -> float:
        """From the camera to the plane of the face [m]."""
        return self.layout.rear_face_x - self.thickness - float(self.camera.origin[0])

    @property
    def corner(self) -> tuple[float, float]:
        """Base y, z of the true corner from the camera [m]; the slider follows the door width."""
        slider = float(self.camera.origin[1]) - self.width / 2.0
        return (
            self.layout.centre_y - self.width / 2.0 + self.offset.y - slider,
            self.layout.bottom_z + self.offset.z - float(self.camera.origin[2]),
        )
