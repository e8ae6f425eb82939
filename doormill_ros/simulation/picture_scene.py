"""What stands before the camera in a simulated picture, and the truth about it.

Lengths in metres, angles in radians. Brightness is a share of the sensor's full scale.
Nothing here is shared with the localisation: the camera file is read on its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml

from doormill_ros.cell.layout import CellLayout, DoorOffset, load_layout
from doormill_ros.resources import resource


@dataclass(frozen=True, eq=False)
class SceneCamera:
    """The true camera.

    Attributes:
        matrix: Intrinsic matrix [px], shape (3, 3).
        brown: k1, k2, p1, p2, k3, shape (5,).
        shape: Rows and columns of the picture.
        origin: x, slider y and z of the projection centre in base [m], shape (3,).
    """

    matrix: np.ndarray
    brown: np.ndarray
    shape: tuple[int, int]
    origin: np.ndarray

    @staticmethod
    def load(path: Path | None = None) -> SceneCamera:
        """The camera of config/camera.yaml, taken to be true."""
        document = yaml.safe_load((path or resource("config/camera.yaml")).read_text(encoding="utf-8"))
        columns, rows = document["size"]
        mounting = document["mounting"]
        return SceneCamera(
            matrix=np.array(document["intrinsics"]["k"], dtype=float),
            brown=np.array(document["distortion"]["coefficients"], dtype=float),
            shape=(int(rows), int(columns)),
            origin=np.array([mounting["x"], mounting["slider_y"], mounting["z"]], dtype=float),
        )


@dataclass(frozen=True)
class Surface:
    """A flat surface: mean brightness, and relative contrast of its fine and streaky texture.

    Attributes:
        brightness: Mean, 0..1 of full scale under unit light.
        mottle: Relative standard deviation of an isotropic texture.
        mottle_size: Its correlation length [m].
        grain: Relative standard deviation of streaks (wood grain).
        grain_width: Correlation length across the streaks [m].
        grain_angle: Direction of the streaks from the door's z axis towards y [rad].
    """

    brightness: float
    mottle: float = 0.0
    mottle_size: float = 1.0e-3
    grain: float = 0.0
    grain_width: float = 0.8e-3
    grain_angle: float = 0.0


@dataclass(frozen=True)
class Edges:
    """How the saw left the two edges.

    Attributes:
        roughness: RMS deviation from the straight line [m].
        correlation: Distance over which the roughness' autocorrelation falls to 1/e [m].
        squareness: Angle of the bottom edge above the normal of the hinge edge [rad].
    """

    roughness: float = 0.0
    correlation: float = 2.0e-3
    squareness: float = 0.0


@dataclass(frozen=True)
class Light:
    """Uneven light: level, and linear and quadratic change over the picture.

    Attributes:
        level: Factor on all brightness.
        gradient: Relative change from the middle to the right and lower margin.
        vignetting: Relative loss at the picture's corners.
    """

    level: float = 1.0
    gradient: tuple[float, float] = (0.0, 0.0)
    vignetting: float = 0.0


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
        offset: The true offset from the nominal place.
        face: Face of the door.
        background: Wall of the cell behind the door.
        edges: Outline of the door's face.
        light: Lighting.
        sensor: Optics and noise.
        camera: The true camera.
        layout: Where the nominal door stands.
    """

    width: float
    thickness: float
    offset: DoorOffset = DoorOffset()
    face: Surface = Surface(0.65)
    background: Surface = Surface(0.18)
    edges: Edges = Edges()
    light: Light = Light()
    sensor: Sensor = Sensor()
    camera: SceneCamera = field(default_factory=SceneCamera.load)
    layout: CellLayout = field(default_factory=load_layout)
