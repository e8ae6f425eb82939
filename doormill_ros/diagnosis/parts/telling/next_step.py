"""A thing to measure next, as data and in English; without numpy, for who only tells of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

_OTHERWISE = "mill the next doors with other recipes: features elsewhere on the door, cut in other directions"
_MORE_PLACES = (
    "inspect doors whose features lie in at least three other places: forces, tool and place show on one door, joints "
    "and weight only over several"
)
_NOTHING = "nothing: the next door of each recipe is inspected as before"
#: Kinds of steps.
POINTS, CHECK, MORE_PLACES, RECIPES, NOTHING = STEPS = ("points", "check", "places", "recipes", "nothing")


@dataclass(frozen=True)
class NextStep:
    """One thing to measure next, as data, so that it can be said in any language.

    Attributes:
        step: One of STEPS.
        cause, other: The two to be told apart; empty where there are none.
        by: Of a check, the cause whose own check tells them apart; empty where other recipes do.
        points: How many more points, of POINTS.
        feature, recipe: On which feature of which recipe.
    """

    step: str
    cause: str = ""
    other: str = ""
    by: str = ""
    points: int = 0
    feature: str = ""
    recipe: str = ""

    def sentence(self, checks: Mapping[str, str]) -> str:
        """In English.

        Args:
            checks: What shows a cause without another door, by the cause's name.
        """
        pair = f"to tell {self.cause} from {self.other}"
        if self.step == POINTS:
            return f"{pair}, measure about {self.points} more points on {self.feature} of {self.recipe}"
        if self.step == CHECK:
            return f"{pair}, {checks.get(self.by, _OTHERWISE)}"
        return {MORE_PLACES: _MORE_PLACES, RECIPES: _OTHERWISE, NOTHING: _NOTHING}[self.step]


def next_sentence(steps: Sequence[NextStep], checks: Mapping[str, str]) -> str:
    """The steps in one English sentence; for `checks` see `NextStep.sentence`."""
    return "; ".join(dict.fromkeys(step.sentence(checks) for step in steps))


def next_document(steps: Sequence[NextStep]) -> list[dict[str, Any]]:
    """As diagnosis.json has them."""
    return [asdict(step) for step in steps]
