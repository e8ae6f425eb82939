"""How a robot stands to gravity, and what it carries beyond its own links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.link_masses import LinkMass


@dataclass(frozen=True, eq=False)
class Stance:
    """Direction of gravity and load at the flange.

    Attributes:
        down: Unit vector along gravity in base axes, shape (3,).
        load: Mass and centre of mass in the frame of the flange of what the links do not tell; None for nothing.
    """

    down: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, -1.0]))
    load: LinkMass | None = None

    def carried(self, links: Sequence[LinkMass]) -> tuple[LinkMass, ...]:
        """Links 1 to J with the load in the last of them; none where no masses are known."""
        if self.load is None or not links:
            return tuple(links)
        *others, last = links
        mass = last.mass + self.load.mass
        com = (last.mass * last.com + self.load.mass * self.load.com) / mass
        return (*others, LinkMass(mass, com))

    def document(self) -> dict[str, Any]:
        """For a file: `down`, and `load` where there is one."""
        found: dict[str, Any] = {"down": [float(v) for v in self.down]}
        if self.load is not None:
            found["load"] = {"mass": float(self.load.mass), "com": [float(v) for v in self.load.com]}
        return found

    @classmethod
    def read(cls, entry: dict[str, Any]) -> Stance:
        """The stance of a file.

        Raises:
            KeyError: Something is missing.
            ValueError: A number is none, or gravity has no direction.
        """
        down = np.array(entry["down"], dtype=float)
        if down.shape != (3,) or not abs(float(np.linalg.norm(down)) - 1.0) < 1e-6:
            raise ValueError("the direction of gravity is no unit vector")
        load = entry.get("load")
        return cls(
            down, load and LinkMass(float(load["mass"]), np.array(load["com"], dtype=float).reshape(3))
        )


#: Gravity along -z of the base, nothing at the flange but what the links tell.
UPRIGHT = Stance()
