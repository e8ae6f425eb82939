"""What a diagnosis of inspected doors comes to, in a sentence and a few figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from doormill_ros.diagnosis.parts.telling.next_step import NextStep
from doormill_ros.units import m_to_mm

ALWAYS = "always"
UNKNOWN = -1.0  #: of an error that nobody can tell


@dataclass(frozen=True)
class NamedFault:
    """A cause, and since when.

    Attributes:
        cause, where: Name and place.
        course: ALWAYS, "step" or "drift".
        from_run: First run with it; empty where all have it.
        from_door: What that run milled.
    """

    cause: str
    where: str
    course: str = ALWAYS
    from_run: str = ""
    from_door: str = ""

    @property
    def words(self) -> str:
        """The cause as a part of a sentence."""
        name = f"{self.cause.replace('_', ' ')} at {self.where}"
        if self.course == ALWAYS:
            return name
        door = f" (door {self.from_door})" if self.from_door else ""
        verb = "drifts" if self.course == "drift" else "began or changed"
        return f"{name} that {verb} from run {self.from_run}{door} on"


@dataclass(frozen=True)
class DoorFinding:
    """What the doors say.

    Attributes:
        verdict: consistent, explained, partly_explained or unexplained.
        sentence: The same in words.
        faults: What is named.
        remarks: Whatever else the doors tell.
        next_measurement: What to measure next, in English.
        next_steps: The same as data; empty where an older diagnosis was read.
        questioned: How many doors were asked.
        expected: Error of the next door with the model in use [m]; UNKNOWN where nobody can tell.
        expected_found: The same with the model that was found.
        better: The model that was found differs from the one in use by more than doors can be measured, and leaves
            less.
    """

    verdict: str
    sentence: str
    faults: tuple[NamedFault, ...]
    remarks: tuple[str, ...]
    next_measurement: str
    next_steps: tuple[NextStep, ...]
    questioned: int
    expected: float
    expected_found: float
    better: bool


def finding_of(document: Mapping[str, Any], door_of: Mapping[str, str]) -> DoorFinding:
    """Read diagnosis.json of inspected doors.

    Args:
        document: Its content.
        door_of: What each run milled.

    Raises:
        KeyError, TypeError, ValueError: It is no such document.
    """
    faults = []
    for cause in document["causes"]:
        key = cause["cause"], cause["where"]
        # A mill that wears and is changed drifts, and has a step.
        changes = [one for one in document["changes"] if (one["what"], one["where"]) == key]
        faults += [] if changes else [NamedFault(*key)]
        for change in changes:
            run_id = str(change["from_run"])
            faults.append(NamedFault(*key, str(change["kind"]), run_id, door_of.get(run_id, "")))
    in_use = document["in_use"]
    expected, found = float(in_use["expected_error"]), float(in_use["expected_error_extended"])
    better = float(in_use["difference"]) > float(document["noise_floor"]) and found < expected
    count = len(document["inspections"])
    return DoorFinding(
        str(document["verdict"]),
        _sentence(str(document["verdict"]), faults, count, better, expected),
        tuple(faults),
        tuple(str(remark) for remark in document["remarks"]),
        str(document["next_measurement"]),
        tuple(NextStep(**step) for step in document.get("next", ())),
        count,
        expected,
        found,
        better,
    )


def _sentence(verdict: str, faults: Sequence[NamedFault], count: int, better: bool, expected: float) -> str:
    doors = "1 door" if count == 1 else f"{count} doors"
    named = " and ".join(fault.words for fault in faults)
    if verdict == "consistent":
        said = f"{doors}: the robot does what its joint springs say"
    elif verdict == "explained":
        said = f"{doors}, explained by {named}"
    elif verdict == "partly_explained":
        said = f"{doors}: {named} explains a part, something without a name remains"
    else:
        said = f"{doors}: something is wrong, and no known cause earns its place"
    left = f"the next door is expected within {m_to_mm(expected):.2f} mm"
    return f"{said}; {left}, {'a better model is proposed' if better else 'the model in use has what can be corrected'}"
