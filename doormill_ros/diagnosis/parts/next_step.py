"""A thing to measure next, as data and in English; without numpy, for who only tells of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

#: What shows a cause without another door.
CHECKS = {
    "camera_shift": "picture a door whose edges were probed in the clamp",
    "clamp_shift": "picture a door in the clamp before and after milling",
    "process_force": "mill a test cut at half the feed: a force changes with it, a spring does not",
    "process_force_direction": "mill a test cut in the opposite direction: a force turns with it",
    "joint_stiffness": "load the joint with a known weight",
    "joint_backlash": "mill a wall twice, reached from both sides",
    "tool_bending": "mill the same pocket with a shorter mill",
    "tool_compliance": "press against the spindle and read a dial on the flange",
    "base_compliance": "press against the robot and read a dial at its foot",
    "tool_radius": "measure the mill, or mill a groove of its width",
    "tool_length": "measure the length of the mill",
    "gravity_sag": "mill a shallow pocket at the ends of the door's edge, where the arm reaches farthest and least",
    "path_lag": "mill the same pocket at half the feed: what a controller lags falls to a quarter",
    "link_geometry": "measure the robot's poses with a laser tracker",
    "joint_hardening": "load the joint with two known weights",
    "thermal_growth": "mill one door cold and the same door after an hour of work",
}
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

    @property
    def sentence(self) -> str:
        """In English."""
        pair = f"to tell {self.cause} from {self.other}"
        if self.step == POINTS:
            return f"{pair}, measure about {self.points} more points on {self.feature} of {self.recipe}"
        if self.step == CHECK:
            return f"{pair}, {CHECKS.get(self.by, _OTHERWISE)}"
        return {MORE_PLACES: _MORE_PLACES, RECIPES: _OTHERWISE, NOTHING: _NOTHING}[self.step]


def next_sentence(steps: Sequence[NextStep]) -> str:
    """The steps in one English sentence."""
    return "; ".join(dict.fromkeys(step.sentence for step in steps))


def next_document(steps: Sequence[NextStep]) -> list[dict[str, Any]]:
    """As diagnosis.json has them."""
    return [asdict(step) for step in steps]
