"""What the judge found."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DoormillError
from doormill_ros.simulation.errors import (
    BodyTouched,
    MilledWrongWay,
    PlungedDown,
    WoodOutsideFeatures,
    WoodTornOut,
)
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


@dataclass(frozen=True, eq=False, kw_only=True)
class TornOut(Harm):
    """The mill came out through a face where nothing backed the wood; `depth` is how far its tip came behind it.

    Attributes:
        face: Which one.
        area: Of the wood at the face that it tore out [m^2].
    """

    face: str
    area: float

    @property
    def _what(self) -> str:
        return f"the mill tore {self.area / MM**2:.0f} mm^2 of wood out of the {self.face}, which nothing backs there,"


@dataclass(frozen=True, eq=False, kw_only=True)
class BadCut(Harm):
    """A feature cut in a manner that spoils tool or wall; `depth` is how deep the tip was in the feature.

    Attributes:
        said: What was done and what is allowed.
        steep: True for a way down, False for the way round.
    """

    said: str
    steep: bool

    @property
    def _what(self) -> str:
        return self.said


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a run touched beside the wood to be cut.

    Attributes:
        judged: Executed samples that were looked at.
        touches: By body, obstacle and motion, in the order of time.
        gone: Wood outside the features by motion, in the order of time.
        torn: Wood torn out of faces by motion, in the order of time.
        bad: Features cut in a manner that spoils tool or wall.
    """

    judged: int
    touches: tuple[Touch, ...] = ()
    gone: tuple[WoodGone, ...] = ()
    torn: tuple[TornOut, ...] = ()
    bad: tuple[BadCut, ...] = ()

    @property
    def harm(self) -> tuple[Harm, ...]:
        """All of it, bodies first."""
        return (*self.touches, *self.gone, *self.torn, *self.bad)

    @property
    def touched_samples(self) -> int:
        """Executed samples in which anything was touched that must not be."""
        return len(frozenset[int]().union(*(harm.samples for harm in self.harm)))

    @property
    def volume(self) -> float:
        """All wood gone outside the features [m^3]."""
        return float(sum(item.volume for item in self.gone))

    @property
    def error(self) -> DoormillError | None:
        """Why the run failed, the gravest of what was found; None when it harmed nothing."""
        if not self.harm:
            return None
        said = []
        kinds: tuple[tuple[Harm, ...], ...] = (self.touches, self.gone, self.torn, self.bad)
        for kind in kinds:
            if kind:
                worst = max(kind, key=lambda item: item.depth)
                said += list(dict.fromkeys(item.sentence for item in (kind[0], worst)))
        if self.touches or self.gone:
            rule = (
                "allowed is to touch nothing but the wood to be cut, something else was touched in "
                f"{self.touched_samples} of {self.judged} samples: plan another way, or mill the door in another place"
            )
        elif self.torn:
            rule = "allowed is to come out of a face where a board backs the wood: place one, or mill from both sides"
        else:
            rule = (
                "allowed is what tool and recipe say: declare another tool or direction, or plan another way"
            )
        sentence = f"{'; '.join(said)}; {rule}"
        by_weight = (
            (bool(self.touches), BodyTouched),
            (bool(self.gone), WoodOutsideFeatures),
            (bool(self.torn), WoodTornOut),
            (any(item.steep for item in self.bad), PlungedDown),
        )
        error = next((kind for found, kind in by_weight if found), MilledWrongWay)
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
