"""What is known of loadings besides posture and load: when, for how long, how warm, and what was measured."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Circumstances:
    """Of n loadings; None where nobody knows.

    Attributes:
        time: Since the start of the test, shape (n,) [s].
        dt: Time under load, shape (n,) [s].
        temperature: Shape (n,) [deg C], NaN where it was not recorded.
        reflector: Name of the reflector that was measured, shape (n,).
    """

    time: FloatArray | None = None
    dt: FloatArray | None = None
    temperature: FloatArray | None = None
    reflector: FloatArray | None = None


NOTHING_KNOWN = Circumstances()
