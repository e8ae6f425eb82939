"""What a kind of data gives to its laws: what can be off, and what can drive that."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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


@dataclass(frozen=True)
class Drivers(Generic[Seen]):
    """What can drive an effect in one kind of data.

    Attributes:
        named: By their names, but for those that name another joint.
        of_joint: What is said of any joint, as in "torque of joint 2" or "direction (of joint 2)".
    """

    named: Mapping[str, Driver[Seen]]
    of_joint: Mapping[str, Driver[Seen]]

    def driver(self, name: str) -> Driver[Seen]:
        """A driver by its name.

        Raises:
            KeyError: There is none of that name.
        """
        kind, other = meant(name)
        return self.named[name] if other is None else self.of_joint[kind]

    def reading(self, name: str, seen: Seen, joint: int) -> FloatArray:
        """Value of a driver in each row for an effect at a joint (0 ..., -1 for none), shape (n,)."""
        other = meant(name)[1]
        return self.driver(name).reading(seen, joint if other is None else other)


def number_of(where: str) -> int:
    """Index 0 ... 5 of "joint 3" or "link 3"; -1 for a place without one."""
    kind, _, count = where.partition(" ")
    return int(count) - 1 if kind in ("joint", "link") else -1


def meant(driver: str) -> tuple[str, int | None]:
    """What of which joint, by its index 0 ..., as in "torque of joint 2" or "speed (of joint 2)"; None without one."""
    kind, found, joint = driver.rstrip(")").replace(" (of", " of").partition(" of joint ")
    return kind, int(joint) - 1 if found else None
