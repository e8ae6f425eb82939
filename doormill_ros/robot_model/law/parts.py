"""What a kind of data gives to its laws: what can be off, and what can drive that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from doormill_ros.arrays import FloatArray

#: How one unit of what is off shows in the data of a kind.
Motion = TypeVar("Motion")
#: What a kind's terms look at.
Seen = TypeVar("Seen")


@dataclass(frozen=True)
class Carrier(Generic[Motion]):
    """Something that can be off.

    Attributes:
        motion: What one unit of each component does to what is measured.
        unit: Of an amplitude, SI; "1" for a share.
        size: A typical amplitude.
        does: What it does, in words, before the amount.
        of_robot: Whether it is in the robot and not in the measuring chain.
        components: How many motions there are.
    """

    motion: Motion
    unit: str
    size: float
    does: str
    of_robot: bool = True
    components: int = 1


@dataclass(frozen=True)
class Driver(Generic[Seen]):
    """Something that an effect may hang on.

    Attributes:
        reading: Its value in each row, shape (n,), of what is measured and the joint (0 ... 5, -1 for none) at which
            the effect acts, or that is spoken of.
        unit: SI.
        of_path: Whether a milling path knows it.
    """

    reading: Callable[[Seen, int], FloatArray]
    unit: str
    of_path: bool = True


def number_of(where: str) -> int:
    """Index 0 ... 5 of "joint 3" or "link 3"; -1 for a place without one."""
    kind, _, count = where.partition(" ")
    return int(count) - 1 if kind in ("joint", "link") else -1


def meant(driver: str) -> tuple[str, int | None]:
    """What of which joint, by its index 0 ..., as in "torque of joint 2" or "speed (of joint 2)"; None without one."""
    kind, found, joint = driver.rstrip(")").replace(" (of", " of").partition(" of joint ")
    return kind, int(joint) - 1 if found else None
