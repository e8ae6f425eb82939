"""One way through sets of causes for every kind of data: what earns its place joins, what does not leaves."""

from dataclasses import dataclass
from itertools import combinations

import pytest

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.core.judgement import Judgement
from doormill_ros.diagnosis.core.searching.search import Search
from doormill_ros.robot_model.candidate import Cause

#: What each letter takes away of the error of a model that holds it; a pair may be worth more or less than its parts.
WORTH = {"a": 30.0, "b": 20.0, "c": 11.0, "d": 1.0, "e": 0.5, "f": 0.2}
PRICE = 5.0


class Letter(Cause):
    """A cause by one letter."""

    def __init__(self, name, named=True):
        super().__init__("here")
        self.name, self.named = name, named


@dataclass(frozen=True)
class Word:
    """A model of some letters."""

    members: tuple[Letter, ...]

    @property
    def text(self):
        return "".join(sorted(letter.name for letter in self.members))


class Letters(Search[Letter, Word]):
    """Models whose errors are looked up."""

    largest = swaps = 4

    def __init__(self, together=None, unnamed="", everything=False):
        self.letters = [Letter(name, name not in unnamed) for name in WORTH]
        self.together, self.everything, self.asked = together or {}, everything, []
        if everything:
            self.largest, self.swaps, self.at_once = 0, 0, 0.5

    def starts(self):
        return [Word(tuple(self.letters) if self.everything else ())]

    def total(self, model):
        bonus = sum(gain for pair, gain in self.together.items() if set(pair) <= set(model.text))
        return PRICE * len(model.members) - sum(WORTH[name] for name in model.text) - bonus

    def ranked(self, models):
        return sorted(models, key=self.total)

    def grown(self, beam, smaller, best):
        return [
            word for model in beam for letter in self.offers(model, None) if (word := self.add(model, letter))
        ]

    def offers(self, model, instead):
        return [one for one in self.letters if one not in model.members and one is not instead]

    def add(self, model, cause):
        return Word((*model.members, cause))

    def earns(self, smaller, larger):
        return self.total(larger) < self.total(smaller)

    def without(self, model, *causes):
        return Word(tuple(letter for letter in model.members if letter not in causes))

    def useless(self, model, asked, strictly):
        self.asked.append("".join(letter.name for letter in asked))
        gains = [(one, self.total(self.without(model, one)) - self.total(model)) for one in asked]
        return [(one, gain) for one, gain in gains if gain <= 0.0]


def every_subclass(kind):
    return {kind}.union(*(every_subclass(one) for one in kind.__subclasses__()))


def test_what_earns_its_place_joins_and_nothing_else():
    assert Letters().run().text == "abc"


def test_what_a_newcomer_makes_useless_leaves():
    """With b and c together, a says nothing that they do not."""

    class Unswapped(Letters):
        swaps = 0

    assert Unswapped({"ab": -20.0, "ac": -5.5, "bc": 10.0}).run().text == "bc"


def test_a_better_letter_takes_the_place_of_one_that_came_first():
    class Narrow(Letters):
        largest = 2

    found = Narrow({"ab": -18.0, "ac": -5.0, "bc": 15.0}).run()
    assert found.text == "bc", "a is the best alone and stands in no best pair"


def test_two_give_way_to_two_that_no_single_exchange_leads_to():
    class Two(Letters):
        largest = 2

        def two_instead(self, model, one, other):
            rest = self.without(model, one, other)
            others = [letter for letter in self.letters if letter not in (*rest.members, one, other)]
            return [Word((*rest.members, *pair)) for pair in combinations(others, 2)]

    # "de" is the best pair by far, and with one of its letters beside one of the others it is worth nothing.
    together = {"de": 70.0}
    assert Letters.two_instead(Letters(), Word(()), None, None) == ()
    assert Two(together).run().text == "de"

    class One(Two):
        two_instead = Letters.two_instead

    assert One(together).run().text == "ab"


def test_from_everything_the_useless_leave_half_at_a_time():
    search = Letters(everything=True)
    assert search.run().text == "abc"
    # Two of three leave and the third alone is asked again; in the end all that stayed.
    assert search.asked == ["abcdef", "d", "abc"]


def test_shapes_without_a_name_are_for_what_named_causes_leave():
    class NamedFirst(Letters):
        shapes_last, largest, swaps = True, 1, 0

    assert NamedFirst(unnamed="a").run().text == "b"
    assert Letters(unnamed="a").climbed(Word(())).text == "abc"


@pytest.mark.parametrize("beam", [1, 5])
def test_the_best_set_is_found_where_worths_add_up(beam):
    class Wide(Letters):
        pass

    Wide.beam = beam
    search = Wide()
    words = [Word(some) for size in range(5) for some in combinations(search.letters, size)]
    assert search.total(search.run()) == min(map(search.total, words))


def test_no_kind_of_data_has_a_way_or_a_verdict_of_its_own():
    assert [listed.make() for listed in kinds.KINDS], "importing them defines their searches and answers"
    searches = {one for one in every_subclass(Search) if one.__module__.startswith("doormill_ros.")} - {
        Search
    }
    assert {one.__name__ for one in searches} == {"BeamSearch", "JointSearch", "LawSearch", "PoseSearch"}
    for one in searches:
        assert not {"run", "climbed", "first_earning", "prune", "swapped"} & set(vars(one)), one
    assert {one.__name__ for one in every_subclass(Judgement)} >= {
        "Diagnosis",
        "PoseDiagnosis",
        "MotionDiagnosis",
    }


class Restless(Letters):
    """A search in which each newcomer pushes out what was there, and is pushed out in turn."""

    def __init__(self):
        super().__init__()
        self.steps = 0

    def first_earning(self, best, grown):
        self.steps += 1
        assert self.steps < 20, "it goes round for ever"
        newcomer = self.letters[0] if best.text == "b" else self.letters[1]
        return Word((*best.members, newcomer))

    def prune(self, best, strictly=False):
        return Word(best.members[-1:])

    def finished(self, best):
        return best


def test_causes_that_push_each_other_out_end_the_search():
    search = Restless()
    assert search.climbed(Word(())).text in ("a", "b")
    assert search.steps <= 3
