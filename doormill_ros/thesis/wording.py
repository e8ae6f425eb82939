"""What six printed lengths decide and what they leave open, in sentences."""

from __future__ import annotations

from doormill_ros.diagnosis.core.words.wording import spoken, with_deviation
from doormill_ros.thesis.diagnosis import AS_GOOD, ThesisDiagnosis


def candidates_sentence(found: ThesisDiagnosis) -> str:
    """The candidates with their sizes and misfits, and what parts them from the others."""
    listed = "; ".join(
        f"{spoken(c.cause)} of {with_deviation([c.value], [c.std], c.cause.parameters[0].unit)} (squared deviations "
        f"{c.misfit:.2f})"
        for c in found.candidates
    )
    worst = max(abs(row.extended / row.measured - 1.0) for row in found.rows if row.joint in (3, 5))
    return (
        f"One of {len(found.candidates)} changes brings both close (to {100 * worst:.0f} % by the first): {listed}. "
        f"They differ by less than {AS_GOOD:.0f}, which in five lengths decides nothing; without any of them the "
        f"squared deviations are {found.before:.0f}."
    )


def joint_3_sentence(found: ThesisDiagnosis) -> str:
    """What the tests say about the spring of joint 3, if it is the spring."""
    alone, both = found.joint_3
    return (
        f"If it is the spring of joint 3, test 3 alone puts it at {found.joint_3_plain:.3f} of joint 1's when the "
        f"load hangs straight down and bends joints 2 and 3 only ({alone:.3f} with the printed wrench on all joints), "
        f"tests 3 and 5 together at {both:.3f}; table 4.1 says 0.689. What five lengths can decide: table 4.1 makes "
        "the springs too soft together, in joint 2 or in joint 3. What they cannot decide: which of the two it "
        "is, and whether it is a spring or friction."
    )
