"""A law in one line, and what test would tell what it is."""

from __future__ import annotations

from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.words.wording import spoken
from doormill_ros.robot_model.candidate import Candidate
from doormill_ros.robot_model.law.term import Term

#: What would tell what a law is, by what drives it.
TESTS = {
    "own angle": "load this joint alike at ten angles a few degrees apart: waves of a gear come back with its teeth, "
    "a cable or a counterweight does not",
    "angle of joint k": "keep all joints but that one, load alike at six of its angles: a cable or a parallel arm "
    "follows it, a gear does not",
    "own torque": "load one posture in ten steps up and down, both signs: a kink is a stop, a bend a bearing, two "
    "branches are friction",
    "torque of joint k": "load so that only one of the two joints feels a torque: a shared shaft or belt couples them, "
    "a wrong lever does not",
    "direction": "approach one posture from both sides, ten times each, and load it: friction keeps a share, a gap a "
    "fixed angle",
    "torque sign": "load one posture alike in both senses: a preloaded gear or a one-sided stop differs",
    "time": "repeat the first postures at the end: a step is a slip or a blow, a slope is wear or warming",
    "time under load": "hold one load for an hour, unload and go on reading: creep comes back slowly, warming follows "
    "the thermometer, a drifting tracker does not stop at unloading",
    "temperature": "repeat three postures cold and after an hour of motion, with a thermometer at the gear",
    "speed": "repeat at three speeds: friction of a gear grows with it, play does not",
    "wrench": "hang known masses at two levers: a sensor errs with its channel, a part that bends with the lever",
    "constant": "load nothing and read twice, then hang a known mass: what stays is of the sensor, what is at one "
    "reflector only is its seat",
    "path": "come to one posture on three ways",
}
#: The same of a driver that has no test of its own.
_ANY = "change the {} alone and keep all else as it was: only what hangs on it follows"


def test_of(driver: str) -> str:
    """What would tell what a law is, by what drives it."""
    kind, _, joint = driver.partition(" of joint ")
    test = TESTS.get(f"{kind} of joint k" if joint else kind)
    return _ANY.format(driver) if test is None else test.replace("that one", f"joint {joint}")


def law_in_words(term: Candidate[Any], weights: FloatArray) -> str:
    """The law in one line with numbers and units; weights in SI, shape (p,)."""
    if isinstance(term, Term):
        return term.told(weights)
    numbers = []
    at = 0
    for parameter in term.parameters:
        part = weights[at : at + parameter.size]
        at += parameter.size
        numbers.append(f"{parameter.name} {', '.join(f'{v:.3g}' for v in part)} {parameter.unit}")
    return f"as {spoken(term)} would, which is not believed: {'; '.join(numbers)}"
