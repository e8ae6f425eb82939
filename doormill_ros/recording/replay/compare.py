"""Find where replayed answers differ from the expected ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from doormill_ros.recording.replay.answer import MAKERS, STAGES, Answer, Value, stage_of
from doormill_ros.recording.replay.tolerance import EXACT, distance, equal, tolerance_of
from doormill_ros.units import ns_to_s

NOTHING = "nothing"


@dataclass(frozen=True)
class Difference:
    """One field that is not as expected.

    Attributes:
        run_id: Run it belongs to.
        topic: Where.
        stamp_ns: Stamp of the picture in question, 0 when there is none.
        field: Path of the field in the message.
        expected: What was recorded.
        found: What the replay gave.
    """

    run_id: str
    topic: str
    stamp_ns: int
    field: str
    expected: Value | None
    found: Value | None

    def __str__(self) -> str:
        """Topic, time, field, expected, found, tolerance, and whose work it is."""
        when = time_text(self.stamp_ns)
        return (
            f"run {self.run_id}: {self.topic} of {when}: {self.field}: expected {_show(self.expected)}, "
            f"found {_show(self.found)}{self._margin()}; made by {MAKERS[stage_of(self.topic)]}"
        )

    def _margin(self) -> str:
        tolerance = tolerance_of(self.field)
        if tolerance is EXACT or self.expected is None or self.found is None:
            return ""
        apart = distance(self.field, self.expected, self.found)
        allowed = f"{tolerance.absolute:.0e}" + (
            f" + {tolerance.relative:.0e} of it" if tolerance.relative else ""
        )
        return f" ({apart:.3g} {tolerance.unit} apart, allowed {allowed} {tolerance.unit})".replace(" )", ")")


def time_text(stamp_ns: int) -> str:
    """UTC time to the microsecond, or that there was no picture."""
    if stamp_ns == 0:
        return "a run without picture"
    return datetime.fromtimestamp(ns_to_s(stamp_ns), UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def _show(value: Value | None) -> str:
    if value is None:
        return NOTHING
    if isinstance(value, list):
        return "[" + ", ".join(f"{v:.9g}" for v in value) + "]"
    return f"{value:.9g}" if isinstance(value, float) else repr(value)


def differences(
    run_id: str, expected: Sequence[Answer], found: Sequence[Answer], slack: float = 1.0
) -> Iterator[Difference]:
    """Every field that differs, stage by stage, in the order of the messages; `slack` as in `equal`."""
    topics = {answer.topic for answer in (*expected, *found)}
    for topic in sorted(topics, key=lambda topic: (STAGES.index(stage_of(topic)), topic)):
        wanted = {a.stamp_ns: a for a in expected if a.topic == topic}
        got = {a.stamp_ns: a for a in found if a.topic == topic}
        for stamp_ns in sorted(wanted.keys() | got.keys()):
            a, b = wanted.get(stamp_ns), got.get(stamp_ns)
            if b is not None and b.not_compared:
                continue
            if a is None or b is None:
                yield Difference(run_id, topic, stamp_ns, "the message", _kind(a), _kind(b))
            else:
                yield from _fields(run_id, a, b, slack)


def _kind(answer: Answer | None) -> str | None:
    if answer is None:
        return None
    return "an answer" if answer.accepted else f"a refusal: {answer.values.get('reason')}"


def _fields(run_id: str, expected: Answer, found: Answer, slack: float) -> Iterator[Difference]:
    for path in {**expected.values, **found.values}:
        a, b = expected.values.get(path), found.values.get(path)
        if a is None or b is None or not equal(path, a, b, slack):
            yield Difference(run_id, expected.topic, expected.stamp_ns, path, a, b)
