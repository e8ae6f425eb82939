"""Every member of a model is asked the same way, whatever kind of fit it comes from."""

import inspect
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.core.examining.examination import (
    MOST_REMAINS,
    Double,
    Examiner,
    compared,
    examined,
)
from doormill_ros.diagnosis.core.judgement import Question, judge_question
from doormill_ros.diagnosis.core.searching.search import Search
from doormill_ros.diagnosis.core.words.margin import Check, Margin
from doormill_ros.robot_model.candidate import Cause

#: What each tone takes away of the squared error of ten bars, and the noise.
WORTH = {"a": 30.0, "b": 20.0, "c": 8.0, "hum": 25.0}
NOISE = 1.0


class Tone(Cause):
    """A cause by its name."""

    def __init__(self, name):
        super().__init__("here")
        self.name, self.named = name, name != "hum"


@dataclass(frozen=True, eq=False)
class Chord:
    """A model of some tones."""

    members: tuple[Tone, ...]

    @property
    def left(self):
        return 100.0 * NOISE**2 + sum(WORTH.values()) - sum(WORTH[tone.name] for tone in self.members)


class Chords(Search[Tone, Chord]):
    """All tones are in from the start."""

    def __init__(self, heard):
        self.tones = {name: Tone(name) for name in WORTH}
        self.heard = heard

    def starts(self):
        return [Chord(tuple(self.tones[name] for name in self.heard))]

    def ranked(self, models):
        return sorted(models, key=lambda chord: chord.left)

    def without(self, model, *causes):
        return Chord(tuple(tone for tone in model.members if tone not in causes))

    def useless(self, model, asked, strictly):
        return []

    def offers(self, model, instead):
        return [tone for tone in self.tones.values() if tone not in model.members and tone is not instead]

    def add(self, model, cause):
        return Chord((*model.members, cause))


class Ear(Examiner[Tone, Chord]):
    """Believes no tone that is too weak or on its list; `dropped` leaves only when the rest is fitted anew."""

    equal = 5.0

    def __init__(self, heard, *, unheard=(), dropped=()):
        self.models, self.unheard, self.dropped = Chords(heard), unheard, dropped

    def baseline(self):
        return Chord(())

    def noise(self, model):
        left = model.left - 100.0 * NOISE**2
        name = "extended" if model.members else "nominal"
        return [Check(left > 1.0, margins=(Margin(f"the {name} model is silent", left, 1.0, "score"),))]

    def checks(self, best, cause, remains):
        worth = Margin(f"{cause!r} is loud", WORTH[cause.name], 10.0, "score")
        return [
            Check(WORTH[cause.name] < 10.0, "it is too weak", (worth,)),
            Check(
                cause.name in self.unheard, "nobody heard it" if remains else "nobody heard it in the silence"
            ),
        ]

    def settled(self, best, named, refused, remains):
        later = [(tone, "it fades") for tone in named if tone.name in self.dropped]
        extended = Chord(tuple(tone for tone in named if tone.name not in self.dropped))
        return extended, extended, later

    def worth(self, asked):
        return [
            Margin(f"{tone!r} stays", self.models.without(asked, tone).left - asked.left, 10.0, "score")
            for tone in asked.members
        ]

    def behind(self, model, rival):
        return rival.left - model.left

    def doubles(self, asked, cause):
        pairs = [(other, self.behind(asked, fit), fit) for other, fit in self.models.rivals(asked, cause)]
        return [
            Double(other, behind, model=fit)
            for other, behind, fit in pairs
            if other.named and abs(behind) < self.equal
        ]


class Listening(Question[Tone, Chord]):
    """Ten bars, each of which holds a tenth of what is left."""

    main_part, noise_floor = 0.5, NOISE

    def __init__(self, heard, **more):
        self.examiner = Ear(heard, **more)

    def search(self, progress):
        return self.examiner.models.run()

    def train_rmse(self, model, kept):
        return (model.left / 100.0) ** 0.5

    holdout_rmse = train_rmse

    def holdout_squares(self, model, kept):
        return np.full(10, model.left / 10.0)


def told(found):
    return {margin.decision: margin.value for margin in found.margins}


def test_a_member_is_refused_for_the_first_thing_that_it_does_not_stand():
    ear = Ear("abc", unheard="bc")
    found = examined(ear, ear.models.run())
    assert [tone.name for tone in found.named] == ["a"]
    assert {tone.name: why for tone, why in found.refused} == {
        "b": "nobody heard it",
        "c": "it is too weak",
    }
    assert found.extended.members == found.named


def test_what_fades_when_the_rest_is_fitted_anew_is_refused_then():
    ear = Ear("ab", dropped="b")
    found = examined(ear, ear.models.run())
    assert [tone.name for tone in found.named] == ["a"]
    assert [(tone.name, why) for tone, why in found.refused] == [("b", "it fades")]


def test_shapes_without_a_name_are_asked_nothing_and_never_named():
    ear = Ear(["a", "b", "c", "hum"])
    found = examined(ear, ear.models.run())
    assert [tone.name for tone in found.named] == ["a", "b"]
    assert not any("hum" in decision for decision in told(found))


def test_every_decision_is_told_with_what_it_was_taken_by():
    ear = Ear("ab")
    found = compared(ear, examined(ear, ear.models.run()))
    assert told(found) == {
        "a at here stays": 30.0,
        "b at here stays": 20.0,
        # The hum, which takes away 25, is next in both places.
        "another cause in place of a at here": 5.0,
        "another cause in place of b at here": -5.0,
        "the nominal model is silent": 83.0,
        "the extended model is silent": 33.0,
        "a at here is loud": 30.0,
        "b at here is loud": 20.0,
    }
    assert found.doubles == ((), ())


def test_a_double_is_not_told_as_the_next_behind():
    class Keen(Ear):
        equal = 13.0

    ear = Keen("ab")
    found = compared(ear, examined(ear, ear.models.run()))
    assert [[double.cause.name for double in doubles] for doubles in found.doubles] == [[], ["c"]]
    assert [double.behind for double in found.doubles[1]] == [12.0]
    assert told(found)["another cause in place of b at here"] == -5.0, "a shape without a name is no double"


def test_withdrawn_causes_are_refused_and_have_no_doubles():
    ear = Ear("ab")
    found = compared(ear, examined(ear, ear.models.run())).withdrawn()
    assert (found.named, found.doubles, found.extended) == ((), (), found.baseline)
    assert [(tone.name, why) for tone, why in found.refused] == [("a", MOST_REMAINS), ("b", MOST_REMAINS)]


@pytest.mark.parametrize(
    ("heard", "verdict", "names", "share"),
    [
        (["a", "b", "hum"], "partly_explained", "ab", 50.0 / 83.0),
        (["a", "hum"], "unexplained", "", 30.0 / 83.0),
        (["c"], "unexplained", "", 0.0),
    ],
)
def test_the_share_that_decides_a_verdict_is_a_margin(heard, verdict, names, share):
    found = judge_question(Listening(heard))
    assert found.verdict == verdict
    assert "".join(tone.name for tone in found.examination.named) == names
    assert told(found)["the causes explain most of what is beyond the noise"] == pytest.approx(share)


def every_subclass(kind):
    return {kind}.union(*(every_subclass(one) for one in kind.__subclasses__()))


def test_no_kind_of_data_examines_in_a_way_of_its_own():
    """A kind says what members have to stand; who is asked what in which order, and what is told, is common."""
    assert [listed.make() for listed in kinds.KINDS], "importing them defines their examiners and questions"
    own = {one for one in every_subclass(Examiner) if one.__module__.startswith("doormill_ros.")} - {Examiner}
    assert {one.__name__ for one in own} == {"FitExaminer", "JointExaminer", "PoseExaminer"}
    for one in own:
        assert not inspect.isabstract(one)
        assert "remains" not in vars(one), one
    # Where joints are searched apart what is said of each is joined, never judged again.
    makers = [
        path.name
        for path in Path(kinds.__file__).parent.rglob("*.py")
        if "Examination(\n" in path.read_text(encoding="utf-8")
    ]
    assert sorted(makers) == ["diagnosis.py", "examination.py"]
