"""What the judge found."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DoormillError
from doormill_ros.simulation.errors import BodyTouched, WoodOutsideFeatures
from doormill_ros.units import m_to_mm

MM3 = 1e9  #: cubic millimetres in a cubic metre
NO_TOUCH = "nothing was touched but the wood to be cut"


@dataclass(frozen=True, eq=False)
class Touch:
    """A body met an obstacle during one motion.

    Attributes:
        body: The body, "mill" for a mill that stands still.
        obstacle: What it met, "door" for the door.
        motion: Number of the motion in the target file, from 1; 0 before the first.
        feature: Feature of the motion, empty between features.
        time: When it first did, since the start of the run [s].
        depth: How far the body would have to be shifted to come free, at its worst [m].
        place: The body's point nearest to the obstacle's middle then, door frame, shape (3,) [m].
        samples: Executed samples in which they met.
    """

    body: str
    obstacle: str
    motion: int
    feature: str
    time: float
    depth: float
    place: FloatArray
    samples: frozenset[int]

    @property
    def sentence(self) -> str:
        """What happened, in one clause."""
        return (
            f"{self.body} touched the {self.obstacle} in motion {self.motion}{_of(self.feature)} after "
            f"{self.time:.2f} s, {m_to_mm(self.depth):.1f} mm deep at {_place(self.place)}"
        )


@dataclass(frozen=True, eq=False)
class WoodGone:
    """The turning mill took wood outside the features during one motion.

    Attributes:
        motion: Number of the motion in the target file, from 1; 0 before the first.
        feature: Feature of the motion, empty between features.
        time: When it first did, since the start of the run [s].
        volume: Of the wood that this motion was the first to take [m^3].
        depth: Farthest from where wood may be taken: from the outline or floor of the motion's feature, or below
            the surface through which the mill came, whichever is less [m].
        place: Where it is deepest, door frame, shape (3,) [m].
        samples: Executed samples in which it did.
    """

    motion: int
    feature: str
    time: float
    volume: float
    depth: float
    place: FloatArray
    samples: frozenset[int]

    @property
    def sentence(self) -> str:
        """What happened, in one clause."""
        return (
            f"the mill took {self.volume * MM3:.0f} mm^3 of wood outside the features in motion {self.motion}"
            f"{_of(self.feature)} after {self.time:.2f} s, {m_to_mm(self.depth):.1f} mm deep at {_place(self.place)}"
        )


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a run touched beside the wood to be cut.

    Attributes:
        judged: Executed samples that were looked at.
        touches: By body, obstacle and motion, in the order of time.
        gone: Wood outside the features by motion, in the order of time.
    """

    judged: int
    touches: tuple[Touch, ...] = ()
    gone: tuple[WoodGone, ...] = ()

    @property
    def touched_samples(self) -> int:
        """Executed samples in which anything was touched that must not be."""
        found: tuple[Touch | WoodGone, ...] = (*self.touches, *self.gone)
        return len(frozenset[int]().union(*(item.samples for item in found)))

    @property
    def volume(self) -> float:
        """All wood gone outside the features [m^3]."""
        return float(sum(item.volume for item in self.gone))

    @property
    def error(self) -> DoormillError | None:
        """Why the run failed, None when it touched nothing: BodyTouched or WoodOutsideFeatures."""
        if not self.touches and not self.gone:
            return None
        said = []
        kinds: tuple[tuple[Touch | WoodGone, ...], ...] = (self.touches, self.gone)
        for kind in kinds:
            if kind:
                worst = max(kind, key=lambda item: item.depth)
                said += list(dict.fromkeys(item.sentence for item in (kind[0], worst)))
        sentence = (
            f"{'; '.join(said)}; allowed is to touch nothing but the wood to be cut, something else was touched in "
            f"{self.touched_samples} of {self.judged} samples: plan another way, or mill the door in another place"
        )
        error = BodyTouched if self.touches else WoodOutsideFeatures
        return error(sentence, touched=self.touched_samples)

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        error = self.error
        return f"{NO_TOUCH} in {self.judged} samples" if error is None else error.message


def _of(feature: str) -> str:
    return f" of {feature}" if feature else ""


def _place(place: FloatArray) -> str:
    x, y, z = m_to_mm(place)
    return f"x {x:.0f}, y {y:.0f}, z {z:.0f} mm of the door"
