"""Region of operation: where to put the robot's foot so that one posture serves every door."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from scipy.ndimage import minimum_filter

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.robot.branch import choose_branch
from doormill_ros.robot.branch_rules import BranchRules
from doormill_ros.robot.description import Robot
from doormill_ros.robot.errors import RobotError
from doormill_ros.units import DEG
from doormill_ros.workspace.doors import DoorRange, FlangeBox
from doormill_ros.workspace.posture import (
    FIGURES,
    POSTURES,
    R_AT_HINGE,
    all_posture_figures,
    posture_figures,
)

_PITCH = 0.05  # m, coarsest spacing of the samples
NEIGHBOURS = 1  #: places so few steps of the lattice apart are taken for one
_SLABS = 20  # parts in which the lattice is computed, for the progress bar
ELBOW = 0.15  #: an elbow that stands out 0.39 m before its axis is then clear of a door 0.25 m before the flange [m]
_WALKS = 200  # candidates tried before the search gives up


@dataclass(frozen=True)
class RegionRules:
    """What must hold everywhere in the box.

    Attributes:
        margin: Distance of joints 1, 2, 3 and 5 from their limits [rad].
        wrist: Angle of axis 5 from straight [rad].
        clearance: How far the elbow stays behind the flange [m].
        distance: Distance of the flange from axis 1 along base x, so that the fixture has room [m].
    """

    margin: float = 3.0 * DEG
    wrist: float = 5.0 * DEG
    clearance: float = 0.0
    distance: float = 1.0


@dataclass(frozen=True, eq=False)
class BoxPlacement:
    """A box in front of a robot, and the worst that happens in it.

    Attributes:
        corner: Smallest flange coordinates of the box, base frame, shape (3,) [m].
        size: Size of the box, shape (3,) [m].
        posture: Arm posture of `POSTURES`.
        conditioning: Smallest inverse condition number [-].
        stiffness: Smallest stiffness in any direction [N/m].
        margin: Smallest joint margin [rad].
        wrist: Smallest angle of axis 5 from straight [rad].
        clearance: Smallest distance of the elbow behind the flange [m].
        refusal: Why no single configuration leads through the whole box; empty when one does.
    """

    corner: FloatArray
    size: FloatArray
    posture: int
    conditioning: float
    stiffness: float
    margin: float
    wrist: float
    clearance: float
    refusal: str = ""

    @property
    def sideways(self) -> float:
        """How far to the side of the robot the middle of the box is, base y [m]."""
        return float(self.corner[1] + self.size[1] / 2.0)

    def pedestal_height(self, lowest_hinge: float) -> float:
        """Height of the robot's base above the floor [m], for the lowest hinge's height [m]."""
        return lowest_hinge - float(self.corner[2])


@dataclass(frozen=True, eq=False)
class RegionSearch:
    """Every placement looked at in the best posture, and the best.

    Attributes:
        best: The best placement, None when no placement keeps to the rules.
        objective: Figure whose worst value was made as large as can be.
        corners: Corner coordinates along x, y and z, three arrays [m].
        worst: Worst value of each figure over the box at every corner, each shape (nx, ny, nz).
        allowed: Where the rules hold, shape (nx, ny, nz).
    """

    best: BoxPlacement | None
    objective: str
    corners: tuple[FloatArray, ...]
    worst: dict[str, FloatArray]
    allowed: BoolArray


def assess(robot: Robot, box: FlangeBox, posture: int = 0, pitch: float = 0.02) -> BoxPlacement:
    """Worst figures of a box, sampled no coarser than `pitch` [m], and a walk all through it."""
    samples = box.samples(pitch)
    figures = asdict(posture_figures(robot, samples.reshape(-1, 3), posture))
    least = {name: float(values.min()) for name, values in figures.items()}
    return _placed(box, posture, least, _walk(robot, box, posture))


def _placed(box: FlangeBox, posture: int, least: dict[str, float], refusal: str = "") -> BoxPlacement:
    """A box with the smallest value of each of `FIGURES` in it."""
    return BoxPlacement(
        box.corner,
        box.size,
        posture,
        least["conditioning"],
        least["stiffness"],
        least["margin"],
        least["wrist"],
        least["clearance"],
        refusal,
    )


@dataclass(frozen=True, eq=False)
class Survey:
    """Worst figures of a box of one size at every place of a lattice around the robot.

    Attributes:
        robot: The robot.
        size: Size of the box, shape (3,) [m].
        corners: Corner coordinates along x, y and z, three arrays [m].
        worst: For each posture of `POSTURES` the worst value of each figure over the box at every
            corner, each shape (nx, ny, nz).
        allowed: For each posture where the rules hold, shape (nx, ny, nz).
    """

    robot: Robot
    size: FloatArray
    corners: tuple[FloatArray, ...]
    worst: dict[int, dict[str, FloatArray]]
    allowed: dict[int, BoolArray]

    def best(self, objective: str = "conditioning") -> RegionSearch:
        """The placement whose worst `objective`, "conditioning" or "stiffness", is largest.

        Raises:
            ValueError: An unknown objective.
        """
        if objective not in ("conditioning", "stiffness"):
            raise ValueError(f"objective is '{objective}', allowed are conditioning and stiffness")

        def top(posture: int) -> float:
            return float(np.max(self.worst[posture][objective], initial=-np.inf, where=self.allowed[posture]))

        posture = max(POSTURES, key=top)
        worst, allowed = self.worst[posture], self.allowed[posture]
        return RegionSearch(self._first_to_walk(posture, objective), objective, self.corners, worst, allowed)

    def candidates(self, objective: str, most: int) -> list[BoxPlacement]:
        """Allowed places of all postures, the best by an objective first, none beside one that is better.

        Args:
            objective: "conditioning" or "stiffness".
            most: How many at most.
        """
        found: list[tuple[float, int, IntArray]] = []
        for posture in POSTURES:
            places = np.argwhere(self.allowed[posture])
            values = self.worst[posture][objective][self.allowed[posture]]
            found += [(float(v), posture, place) for v, place in zip(values, places, strict=True)]
        found.sort(key=lambda item: (-item[0], item[1], tuple(item[2])))
        chosen: list[tuple[float, int, IntArray]] = []
        for item in found:
            if all(item[1] != c[1] or np.abs(item[2] - c[2]).max() > NEIGHBOURS for c in chosen):
                chosen.append(item)
            if len(chosen) == most:
                break
        return [
            _placed(
                FlangeBox(
                    np.array([axis[i] for axis, i in zip(self.corners, place, strict=True)]), self.size
                ),
                posture,
                {name: float(self.worst[posture][name][tuple(place)]) for name in FIGURES},
            )
            for _, posture, place in chosen
        ]

    def _first_to_walk(self, posture: int, objective: str) -> BoxPlacement | None:
        """The best allowed place through whose box one configuration really leads."""
        worst, allowed = self.worst[posture], self.allowed[posture]
        places = np.argwhere(allowed)[np.argsort(-worst[objective][allowed], kind="stable")]
        for place in places[:_WALKS]:
            corner = np.array([axis[i] for axis, i in zip(self.corners, place, strict=True)])
            box = FlangeBox(corner, self.size)
            if not _walk(self.robot, box, posture):
                return _placed(box, posture, {name: float(worst[name][tuple(place)]) for name in FIGURES})
        return None


def survey(
    robot: Robot,
    doors: DoorRange,
    rules: RegionRules | None = None,
    progress: Callable[[float], None] | None = None,
) -> Survey:
    """Look at every robot position and base height for a range of doors.

    The figures are computed once on a lattice of flange positions around the robot. The worst over a
    box, for a box at every place of the lattice, is then a sliding minimum.

    Args:
        robot: The robot.
        doors: Range of doors.
        rules: What must hold everywhere in the box; None for the defaults.
        progress: Called with the finished share, 0 to 1.

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    rules = rules or RegionRules()
    size = doors.travel()
    cells = np.ceil(size / _PITCH - 1e-9).astype(int)
    pitch = np.where(cells > 0, size / np.maximum(cells, 1), _PITCH)
    axes = _lattice(robot, pitch, cells, rules.distance)
    positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    flat = positions.reshape(-1, 3)
    parts = []
    for done, slab in enumerate(np.array_split(flat, _SLABS), start=1):
        parts.append(all_posture_figures(robot, slab))
        if progress:
            progress(done / _SLABS)
    worst: dict[int, dict[str, FloatArray]] = {}
    allowed: dict[int, BoolArray] = {}
    for posture in POSTURES:
        columns = [asdict(part[posture]) for part in parts]
        figures = {name: np.concatenate([column[name] for column in columns]) for name in FIGURES}
        shaped = {name: figures[name].reshape(positions.shape[:3]) for name in FIGURES}
        least = {name: _sliding_minimum(values, cells) for name, values in shaped.items()}
        worst[posture] = least
        allowed[posture] = (
            (least["margin"] >= rules.margin)
            & (least["wrist"] >= rules.wrist)
            & (least["clearance"] >= rules.clearance)
        )
    corners = tuple(axis[: len(axis) - n] for axis, n in zip(axes, cells, strict=True))
    return Survey(robot, size, corners, worst, allowed)


def _lattice(robot: Robot, pitch: FloatArray, cells: FloatArray, distance: float) -> list[FloatArray]:
    """Flange coordinates within reach, from the middle of the box straight ahead to one side.

    A mirror image is as good. The side taken is the one on which the robot stands beyond the
    hinge edge and the wood lies away from it.
    """
    reach = robot.reach + float(np.abs(robot.dh[5, 1]))
    base = float(robot.dh[0, 1])
    x = distance + pitch[0] * np.arange(int(max(reach - distance, 0.0) / pitch[0]) + 1 + cells[0])
    y = pitch[1] * (np.arange(int(1.5 / pitch[1]) + 1 + cells[1]) - cells[1] / 2.0)
    z = pitch[2] * np.arange(np.ceil((base - reach) / pitch[2]), np.floor((base + reach) / pitch[2]) + 1)
    return [x, y, z]


def _sliding_minimum(values: FloatArray, cells: FloatArray) -> FloatArray:
    """Smallest value in the box that starts at each place and spans `cells` lattice steps."""
    window = cells + 1
    smallest = minimum_filter(values, size=tuple(window), mode="nearest", origin=tuple(-(window // 2)))
    inside: FloatArray = smallest[
        tuple(slice(0, length - n) for length, n in zip(values.shape, cells, strict=True))
    ]
    return inside


def _walk(robot: Robot, box: FlangeBox, posture: int) -> str:
    """Lead the flange back and forth through the box in one configuration; the refusal, or ''."""
    samples = box.samples(0.06)
    samples[1::2] = samples[1::2, ::-1]
    flat = samples.reshape(-1, samples.shape[2], 3)
    flat[1::2] = flat[1::2, ::-1]
    positions = flat.reshape(-1, 3)
    T = np.zeros((len(positions), 4, 4))
    T[:, :3, :3], T[:, :3, 3], T[:, 3, 3] = R_AT_HINGE, positions, 1.0
    try:
        choose_branch(
            robot,
            T,
            rules=BranchRules(limit_margin=0.0, wrist=1.0 * DEG, max_step=45.0 * DEG),
            branches=(2 * posture, 2 * posture + 1),
        )
    except RobotError as refusal:
        return refusal.message
    return ""
