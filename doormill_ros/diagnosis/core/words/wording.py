"""Causes and figures as a reader wants them: spoken names, prefixed units, no more digits than are known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from doormill_ros.robot_model.candidate import Cause
from doormill_ros.units import UM

MICRO = "\N{MICRO SIGN}"
#: Prefixes for units that stand alone, by power of ten.
_PREFIXES = {0: "", -3: "m", -6: MICRO, -9: "n"}
_EXACT = 1e-3  #: share to which a number without any deviation is told
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Unit:
    """Unit of a residual, and how figures in it are told.

    Attributes:
        symbol: As diagnosis.json has it.
        told: What follows a figure in a line: "um".
        digits: Behind the point of such a figure.
        size: Of what figures are told in.
        relative: Whether residuals are multiples of the noise, which is 1 then.
    """

    symbol: str
    told: str
    digits: int = 1
    size: float = UM
    relative: bool = False

    def figure(self, value: float) -> str:
        """A residual as a line has it, without the unit."""
        return f"{value / self.size:.{self.digits}f}"

    def spoken(self, value: float) -> str:
        """A residual as a page has it."""
        if self.size != UM:
            return f"{self.figure(value)} {self.told}"
        small = value / UM
        return f"{small:.{1 if small < 100.0 else 0}f} {MICRO}{self.symbol}"


METRES = Unit("m", "um")
RADIANS = Unit("rad", "urad")


@dataclass(frozen=True)
class Words:
    """What a kind of data calls what it judges and what was measured.

    Attributes:
        model: What is judged: "simulation".
        rows: What was measured, one a row: "trials".
        residual: What the model is off by.
        held_out: The same of rows left out.
        unseen: What is left out together.
        method: How a cause was found, for the end of the page.
        assumed: Whether the noise was assumed, since the data do not state all of it.
    """

    model: str
    rows: str
    residual: str = "residual"
    held_out: str = "residual"
    unseen: str = "configurations"
    method: str = ""
    assumed: bool = False

    @property
    def noise(self) -> str:
        """What the noise is called that everything is weighed by."""
        return "assumed noise" if self.assumed else "noise"

    @property
    def noise_alone(self) -> str:
        """The same where nothing else is told beside it."""
        return self.noise if self.assumed else f"measurement {self.noise}"


_SENTENCES = {
    "consistent": "The {model} is right to within the measurement noise. Nothing has to be changed.",
    "explained": "With the extension the model predicts unseen {rows} down to the measurement noise.",
    "partly_explained": "A cause is established, yet the residual still has structure that no known cause explains.",
    "unexplained": "Something is wrong that is not in the library of causes. No cause is named, because a wrong one is "
    "worse than none.",
}
_HANGS = "All this is by a noise that was assumed, since the data do not state it"
#: What is added where the noise was assumed.
_ASSUMED = {
    "consistent": f"{_HANGS}: with less of it something may be wrong.",
    "explained": f"{_HANGS}.",
    "partly_explained": f"{_HANGS}: with more of it nothing may remain.",
    "unexplained": f"{_HANGS}: with more of it nothing may be wrong.",
}


def verdict_sentence(verdict: str, words: Words) -> str:
    """What one of the four verdicts means, for the top of a page."""
    sentence = _SENTENCES[verdict].format(model=words.model, rows=words.rows)
    return f"{sentence} {_ASSUMED[verdict]}" if words.assumed else sentence


def spoken(cause: Cause) -> str:
    """A cause with its place: 'backlash in joint 1', 'sensor gain'."""
    words = cause.name.replace("_", " ")
    body, _, rest = words.partition(" ")
    if cause.where.startswith(("joint", "link")):
        return f"{rest if cause.where.startswith(body) else words} in {cause.where}"
    if cause.where.startswith("set "):
        return f"{words} of {cause.where}"
    if cause.where == "sensor":
        return words.replace("wrench", "sensor")
    if cause.acts_in and rest and body == cause.acts_in:
        return f"{rest} of {body} {cause.where}"
    return words + (f" ({cause.variant})" if cause.variant else "")


def spoken_findings(findings: Sequence[Sequence[Cause]]) -> str:
    """Several findings in one phrase, each a cause and those that are tied with it: 'sensor gain or tracker scale'."""
    return " and ".join(" or ".join(map(spoken, causes)) for causes in findings)


def micrometres(length: float) -> str:
    """A length in metres as micrometres."""
    return METRES.spoken(length)


def with_deviation(values: Sequence[float], stds: Sequence[float], unit: str) -> str:
    """Values and standard deviations with a common power of ten: '(56.6 ± 0.8) mrad'."""
    power = _power(max(map(abs, [*values, *stds])), unit)
    scale = 10.0**power
    finest = min((s for s in stds if s > 0.0), default=max(map(abs, values)) * _EXACT or 1.0) / scale
    digits = min(max(1 - math.floor(math.log10(finest)), 0), 9)
    centre, spread = (", ".join(f"{v / scale:.{digits}f}" for v in row) for row in (values, stds))
    if len(values) > 1:
        centre, spread = f"({centre})", f"({spread})"
    text = f"{centre} ± {spread}"
    if unit == "1":
        return text
    if unit.split(" /")[0] in ("m", "rad") and "(" not in unit:
        return f"({text}) {_PREFIXES[power]}{unit}"
    factor = f" × 10{str(power).translate(_SUPERSCRIPT)}" if power else ""
    return f"({text}){factor} {unit}"


def _power(largest: float, unit: str) -> int:
    """Power of ten, a multiple of three, that brings a number between 1 and 1000."""
    if unit == "1" or largest <= 0.0 or (unit == "N m" and largest < 1e5):
        return 0
    power = 3 * math.floor(math.log10(largest) / 3.0)
    return min(max(power, -9), 0) if unit.split(" /")[0] in ("m", "rad") and "(" not in unit else power
