"""The range of doors a cell shall mill, and the box that the flange must cover for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray

LARGEST = 10.0  #: m, of any door, and of any place of its lower edge


@dataclass(frozen=True)
class DoorRange:
    """Smallest and largest door, hinge edges free to both sides of the centre line [m].

    Attributes:
        thickness: Smallest and largest thickness. The thesis counts from zero (eq. 3.40).
        width: Smallest and largest width; doors stand centred.
        height: Largest height.
        hinge_end: Distance of the lowest hinge from the bottom, and of the highest from the top.
    """

    thickness: tuple[float, float] = (0.0, 0.100)
    width: tuple[float, float] = (0.190, 1.350)
    height: float = 3.000
    hinge_end: float = 0.150

    def __post_init__(self) -> None:
        """Refuse ranges that run backwards.

        Raises:
            ValueError: A range is reversed, negative or empty, or of doors that no robot mills.
        """
        for name, (low, high) in (("thickness", self.thickness), ("width", self.width)):
            if not 0.0 <= low <= high <= LARGEST or high == 0.0:
                raise ValueError(
                    f"door {name} runs from {low} to {high} m, allowed is 0 <= smallest <= largest <= {LARGEST:g} m"
                )
        if not self.height <= LARGEST:
            raise ValueError(f"doors are up to {self.height} m high, allowed are {LARGEST:g} m")
        if not 0.0 <= self.hinge_end < self.height / 2:
            raise ValueError(
                f"hinges start {self.hinge_end} m from the ends of a door {self.height} m high, "
                "allowed is less than half the height"
            )

    def travel(self) -> FloatArray:
        """Travel along x, y and z, shape (3,) [m] (thesis eq. 3.40 to 3.42, table 4.4)."""
        return np.array(
            [
                self.thickness[1] - self.thickness[0],
                (self.width[1] - self.width[0]) / 2.0,
                self.height - 2.0 * self.hinge_end,
            ]
        )


@dataclass(frozen=True, eq=False)
class FlangeBox:
    """Where the flange goes: corner with the smallest coordinates and size, base frame, (3,) [m]."""

    corner: FloatArray
    size: FloatArray

    def samples(self, pitch: float) -> FloatArray:
        """Positions on a regular grid no coarser than `pitch`, shape (nx, ny, nz, 3) [m]."""
        axes = [
            np.linspace(low, low + size, int(np.ceil(size / pitch - 1e-9)) + 1)
            for low, size in zip(self.corner, self.size, strict=True)
        ]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def thesis_box() -> FlangeBox:
    """Region of operation of the thesis (table 4.5)."""
    return FlangeBox(np.array([1.300, -0.290, 0.0]), np.array([0.100, 0.580, 2.700]))
