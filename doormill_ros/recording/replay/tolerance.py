"""How far a replayed value may be from the recorded one.

The code is deterministic; the tolerances leave room for another processor's or library's
rounding only. Each stage gets the recorded input of the stage before, so rounding does not add up.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Tolerance:
    """Largest absolute difference, plus a share of the expected value; `unit` is for the message."""

    absolute: float
    unit: str = ""
    relative: float = 0.0


EXACT = Tolerance(0.0)
#: First pattern that matches the field's path wins.
TOLERANCES: tuple[tuple[str, Tolerance], ...] = (
    (r"^pose\.pose\.position$|^offset_[yz]$", Tolerance(1e-6, "m")),
    (r"^pose\.pose\.orientation$|^offset_rotation$", Tolerance(1e-6, "rad")),
    (r"^pose\.covariance", Tolerance(1e-18, "", relative=1e-3)),
    (r"^pose\.correlation", Tolerance(1e-3)),
    (r"^residual$", Tolerance(1e-7, "m", relative=1e-3)),
    (r"^quality$", Tolerance(1e-3)),
    (r"\.position$|^largest_correction$|expected_error$", Tolerance(1e-7, "m")),
    (r"\.orientation$|\.joint_positions$", Tolerance(1e-7, "rad")),
    (r"\.linear$", Tolerance(1e-8, "m")),
    (r"\.angular$", Tolerance(1e-8, "rad")),
    (r"\.force$", Tolerance(1e-3, "N")),
    (r"\.torque$", Tolerance(1e-3, "N m")),
    (r"\.speed$", Tolerance(1e-9, "m/s")),
    (r"\.spindle_speed$", Tolerance(1e-6, "rad/s")),
    (r"^cycle_time$", Tolerance(1e-3, "s")),
)
#: Numbers inside a sentence are rounded where it is made; its last digit may flip.
IN_SENTENCE = Tolerance(0.011, "", relative=0.01)
IN_FILE = Tolerance(0.002)  #: numbers of the target file, most of them millimetres
CHECKSUM = "#sum "
#: How old a picture was when it was looked at tells of the machine then, and of the machine now.
AGE = re.compile(r"the picture is \S+ s old")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def tolerance_of(path: str) -> Tolerance:
    """The tolerance of a field; EXACT for everything that is not listed."""
    return next((tolerance for pattern, tolerance in TOLERANCES if re.search(pattern, path)), EXACT)


def distance(path: str, expected: object, found: object) -> float:
    """How far two values of a field are apart, in the unit of its tolerance; infinite for other kinds."""
    if isinstance(expected, str) or isinstance(found, str) or isinstance(expected, bool):
        return 0.0 if expected == found else np.inf
    a, b = np.atleast_1d(np.asarray(expected, dtype=float)), np.atleast_1d(np.asarray(found, dtype=float))
    if a.shape != b.shape:
        return np.inf
    if path.endswith("orientation"):
        # Both signs of a quaternion are one rotation; its angle is twice that between the two.
        difference = min(float(np.linalg.norm(a - b)), float(np.linalg.norm(a + b)))
        return 4.0 * float(np.arcsin(min(1.0, difference / 2.0)))
    with np.errstate(invalid="ignore"):
        difference = np.abs(a - b)
    return (
        0.0
        if np.array_equal(a, b, equal_nan=True)
        else float(np.max(np.where(difference >= 0, difference, np.inf)))
    )


def equal(path: str, expected: object, found: object, slack: float = 1.0) -> bool:
    """True when the two values agree within the field's tolerance.

    With a `slack` above 1 tolerances are that many times wider, and numbers in the target file need
    not agree to the last decimal: its targets come from a pose that was found anew.
    """
    if slack > 1.0 and path == "sha256":
        return True
    if slack > 1.0 and path.startswith("line "):
        return _same_line(str(expected), str(found))
    if path in ("reason", "message") and isinstance(expected, str) and isinstance(found, str):
        return same_sentence(AGE.sub("", expected), AGE.sub("", found))
    tolerance = tolerance_of(path)
    apart = distance(path, expected, found)
    if tolerance is EXACT:
        return apart == 0.0
    largest = float(np.max(np.abs(np.asarray(expected, dtype=float)))) if tolerance.relative else 0.0
    return apart <= slack * (tolerance.absolute + tolerance.relative * largest)


def _same_line(expected: str, found: str) -> bool:
    if expected.startswith(CHECKSUM) and found.startswith(CHECKSUM):
        return True
    return same_sentence(expected, found, IN_FILE)


def same_sentence(expected: str, found: str, tolerance: Tolerance = IN_SENTENCE) -> bool:
    """The same words, and numbers that differ by rounding at most."""
    if NUMBER.sub("#", expected) != NUMBER.sub("#", found):
        return False
    pairs: Sequence[tuple[str, str]] = list(zip(NUMBER.findall(expected), NUMBER.findall(found), strict=True))
    return all(
        abs(float(a) - float(b)) <= tolerance.absolute + tolerance.relative * abs(float(a)) for a, b in pairs
    )
