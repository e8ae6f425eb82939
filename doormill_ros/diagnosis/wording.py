"""Causes and figures as a reader wants them: spoken names, prefixed units, no more digits than are known."""

from __future__ import annotations

import math
from collections.abc import Sequence

from doormill_ros.robot_model.elastic.causes.cause import Cause

MICRO = "\N{MICRO SIGN}"
#: Prefixes for units that stand alone, by power of ten.
_PREFIXES = {0: "", -3: "m", -6: MICRO, -9: "n"}
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


_SENTENCES = {
    "consistent": "The {model} is right to within the measurement noise. Nothing has to be changed.",
    "explained": "With the extension the model predicts unseen {rows} down to the measurement noise.",
    "partly_explained": "{established}, yet the residual still has structure that no known cause explains.",
    "unexplained": "Something is wrong that is not in the library of causes. No cause is named, because a wrong one is "
    "worse than none.",
}


def verdict_sentence(verdict: str, model: str, rows: str, established: str) -> str:
    """What a verdict means, for the top of a page.

    Args:
        verdict: One of the four words.
        model: What is judged: "simulation", "nominal model".
        rows: What was measured: "trials", "poses".
        established: How the sentence on a partial explanation begins.
    """
    return _SENTENCES[verdict].format(model=model, rows=rows, established=established)


def spoken(cause: Cause) -> str:
    """A cause with its place: 'backlash in joint 1', 'sensor gain'."""
    words = cause.name.replace("_", " ")
    body, _, rest = words.partition(" ")
    if cause.where.startswith(("joint", "link")):
        return f"{rest if cause.where.startswith(body) else words} in {cause.where}"
    if cause.where == "sensor":
        return words.replace("wrench", "sensor")
    if cause.name == "reflector_position":
        return f"position of reflector {cause.where}"
    return words + (f" ({cause.variant})" if cause.variant else "")


def spoken_findings(findings: Sequence[Sequence[Cause]]) -> str:
    """Several findings in one phrase, each a cause and those that are tied with it: 'sensor gain or tracker scale'."""
    return " and ".join(" or ".join(map(spoken, causes)) for causes in findings)


def micrometres(length: float) -> str:
    """A length in metres as micrometres."""
    return f"{1e6 * length:.{1 if length < 1e-4 else 0}f} {MICRO}m"


def with_deviation(values: Sequence[float], stds: Sequence[float], unit: str) -> str:
    """Values and standard deviations with a common power of ten: '(56.6 ± 0.8) mrad'."""
    power = _power(max(map(abs, [*values, *stds])), unit)
    scale = 10.0**power
    finest = min((s for s in stds if s > 0.0), default=max(map(abs, values)) * 1e-3 or 1.0) / scale
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
