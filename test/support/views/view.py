"""One view: a door in its place, what is on it and about it, and how it is lit and taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from doormill_ros.cell.places.layout import DoorOffset
from support.views.backdrops import Backdrop
from support.views.face import Face
from support.views.light import Light
from support.views.optics import Place
from support.views.solids import Bar, Box


@dataclass(frozen=True)
class Blot:
    """Something on the window before the lens: far out of focus.

    Attributes:
        u: Of its middle [px].
        v: Of its middle [px].
        radius: Of its dark core [px].
        soft: Width of its border [px].
        dim: Share of light that it takes.
        veil: Stray light that it adds, share of full scale.
        shift: How far it bends the picture at its border [px].
    """

    u: float
    v: float
    radius: float
    soft: float
    dim: float
    veil: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True)
class Taking:
    """How the picture is taken.

    Attributes:
        level: Mean of the face in the picture, share of full scale.
        psf: Standard deviation of the point spread in focus [px].
        aperture: Of the lens [m]; things off the focus are less sharp by it.
        focus: Distance in focus less that of the face [m].
        vignetting: Share of light that the corners lack.
        uneven: Share of light that is lost across the picture, and the direction of that [rad].
        motion: Blur (u, v) by motion [px].
        flicker: Share of light in bands, and their height [px].
        photons: Electrons at full scale.
        read: Standard deviation of the read noise [grey levels].
        blots: On the window.
    """

    level: float = 0.5
    psf: float = 0.9
    aperture: float = 8e-4
    focus: float = 0.0
    vignetting: float = 0.1
    uneven: tuple[float, float] = (0.0, 0.0)
    motion: tuple[float, float] = (0.0, 0.0)
    flicker: tuple[float, float] = (0.0, 200.0)
    photons: float = 10000.0
    read: float = 0.6
    blots: Sequence[Blot] = ()


@dataclass(frozen=True, eq=False)
class View:
    """A view with the truth about it.

    Attributes:
        number: In its series.
        seed: Of its series.
        features: Names of what was put in.
        place: Where the door stands.
        told_thickness: What the localizer is told [m].
        face: Of the door.
        backdrop: Behind all.
        behind: Farther than the face.
        before: Nearer than the face or lying against it.
        light: Lamps and shades.
        taking: How the picture is taken.
    """

    number: int
    seed: int
    features: tuple[str, ...]
    place: Place
    told_thickness: float
    face: Face
    backdrop: Backdrop
    light: Light
    taking: Taking
    behind: Sequence[Box | Bar] = field(default=())
    before: Sequence[Box | Bar] = field(default=())

    @property
    def offset(self) -> DoorOffset:
        """Where the door truly stands."""
        return self.place.offset
