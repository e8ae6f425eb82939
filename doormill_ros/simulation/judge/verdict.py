"""What the judge found."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DoormillError
from doormill_ros.simulation.errors import BodyTouched, WoodOutsideFeatures
from doormill_ros.units import MM, m_to_mm

NO_TOUCH = "nothing was touched but the wood to be cut"


@dataclass(frozen=True, eq=False, kw_only=True)
class Harm:
    """What one motion did that it must not.

    Attributes:
        motion: Number of the motion in the target file, from 1; 0 before the first.
        feature: Feature of the motion, empty between features.
        time: When it first did, since the start of the run [s].
        depth: How bad it was at its worst [m].
        place: Where, door frame, shape (3,) [m].
        samples: Executed samples in which it did.
    """

    motion: int
    feature: str
    time: float
    depth: float
    place: FloatArray
    samples: frozenset[int]

    @property
    def sentence(self) -> str:
        """What happened, in one clause."""
        where = f"{m_to_mm(self.depth):.1f} mm deep at {_place(self.place)}"
        return f"{self._what} in motion {self.motion}{_of(self.feature)} after {self.time:.2f} s, {where}"

    @property
    def _what(self) -> str:
        raise NotImplementedError


@dataclass(frozen=True, eq=False, kw_only=True)
class Touch(Harm):
    """A body met an obstacle; it would have to be shifted by `depth` to come free, `place` is its point there.

    Of its points that is the one nearest to the obstacle's middle.

    Attributes:
        body: The body, "mill" for a mill that stands still.
        obstacle: What it met, "door" for the door.
    """

    body: str
    obstacle: str

    @property
    def _what(self) -> str:
        return f"{self.body} touched the {self.obstacle}"


@dataclass(frozen=True, eq=False, kw_only=True)
class WoodGone(Harm):
    """The turning mill took wood outside the features, deepest at `place`.

    The depth is the distance from where wood may be taken: from the outline or floor of the motion's feature, or below
    the surface through which the mill came, whichever is less.

    Attributes:
        volume: Of the wood that this motion was the first to take [m^3].
    """

    volume: float

    @property
    def _what(self) -> str:
        return f"the mill took {self.volume / MM**3:.0f} mm^3 of wood outside the features"


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
        return len(frozenset[int]().union(*(harm.samples for harm in (*self.touches, *self.gone))))

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
        kinds: tuple[tuple[Harm, ...], ...] = (self.touches, self.gone)
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
