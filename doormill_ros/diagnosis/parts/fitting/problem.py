"""Inspected doors made ready for fitting: what any set of effects makes of every measured point."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.course import (
    ALWAYS,
    BEGINS,
    CHANGES,
    DRIFTS,
    GROWS,
    WEARS_AND_CHANGES,
    SizeCourse,
)
from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.fitting.nuisance import Nuisance
from doormill_ros.diagnosis.core.fitting.problem import Examined, Prediction, make_folds
from doormill_ros.diagnosis.core.words.margin import Check
from doormill_ros.diagnosis.core.words.wording import METRES
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.gauged_door import GaugedDoor
from doormill_ros.diagnosis.parts.doors.matching import cut_case
from doormill_ros.diagnosis.parts.doors.order import in_order
from doormill_ros.diagnosis.parts.doors.stretches import stretches
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.diagnosis.parts.effects.registry import effects
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.discrepancy import Discrepancy, made_by
from doormill_ros.diagnosis.parts.fitting.known import moves_enough
from doormill_ros.diagnosis.parts.fitting.moved import by_load, moved
from doormill_ros.diagnosis.parts.fitting.placement import DoorPlaces, door_places, places_of
from doormill_ros.robot.description import Robot
from doormill_ros.statistics import root_mean_square

FEW = 3  #: doors from which on whole features are left out together instead of stretches of them
MANY = 120  #: such groups; from there on whole doors
ROWS = 3000  #: points that are fitted; of more, every second, third, ... counts
DOORS_OVER_TIME = 5  #: from which on something may change
#: Standard deviations to which the surfaces of a mill are known, each common to all doors: its end face and its flank.
#: The face tilts with the robot so that its lower edge cuts, under another load another one: from a step on it is
#: as much off again [m].
FACE, FLANK = 5e-6, 2e-6
_WARMING = 60.0  #: that doors have to take until a cell may have warmed up [s]


class DoorProblem(Examined[InTime]):
    """Deviations of all doors along their normals.

    Attributes:
        robot: That milled.
        tool: Its tool, shape (4, 4).
        doors: In the order in which they were milled.
        door: Number of the door of each point, shape (n,).
        points: All of them.
        steps: Doors from which on something may have changed.
        door_places: Where the doors stood, as far as that is known.
        discrepancies: What doors show and nothing has to name.
    """

    unit = METRES
    components = 1
    resolution = FLANK

    def __init__(
        self,
        doors: Sequence[GaugedDoor],
        robot: Robot,
        T_flange_tool: FloatArray,
        discrepancies: Sequence[Discrepancy] = (),
    ) -> None:
        """Work out loads and geometry, and what the places of the doors can make.

        Args:
            doors: Any number.
            robot: That milled them.
            T_flange_tool: Its tool, shape (4, 4).
            discrepancies: What doors may show and nothing has to name.
        """
        self.robot, self.tool = robot, np.array(T_flange_tool)
        self.doors = in_order(doors)
        every = max(1, -(-sum(len(door.points) for door in doors) // ROWS))
        parts = [door.points[slice(number % every, None, every)] for number, door in enumerate(self.doors)]
        self.points = CutPoints.joined(parts)
        self.door = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        self._case = CutCase(
            load=cut_case(self.points, robot, T_flange_tool),
            normal=self.points.normal,
            wall=self.points.wall,
            kind=self.points.kind,
            tool=self.points.tool,
            bend=self.points.bend,
            late=self.points.late,
            feed=self.points.feed,
            time=self._of_door([door.time for door in self.doors]),
            height=self.points.point[:, 2] - self._of_door([door.T_base_door[2, 3] for door in self.doors]),
            eye=self._of_door([door.eye for door in self.doors]),
            tip=T_flange_tool[:3, 3],
        )
        noise = self._of_door([door.noise for door in self.doors])
        self.noise_floor = root_mean_square(noise)
        varies = [one.varies * one.size for one in discrepancies]
        self.noise = np.hypot(noise, float(np.linalg.norm(varies)))
        self.measured = self.points.deviation - self.points.sent
        self.configuration = self._groups()
        self.folds = make_folds(self.configuration)
        self.steps: tuple[int, ...] = ()
        self._unexplained = (self.measured - self.case.springs()) / self.noise
        self.discrepancies = tuple(discrepancies)
        self._alike = made_by(discrepancies, self._case, self.doors, self.door, self.points, self.noise)
        self.door_places = self._places()
        self.nuisance = self._nuisance()

    def __len__(self) -> int:
        return len(self.points)

    @property
    def case(self) -> CutCase:
        """What the effects look at."""
        return self._case

    def _of_door(self, values: Sequence[float | FloatArray]) -> FloatArray:
        return np.array(values)[self.door]

    def _groups(self) -> IntArray:
        """What is left out together, shape (n,): neighbours know too much of each other."""
        labels = np.char.add(np.char.add(self.door.astype(str), " "), self.points.feature)
        groups = np.unique(labels, return_inverse=True)[1].ravel()
        if len(self.doors) < FEW:
            return stretches(self.points.point, 2 * groups + self.points.wall)
        return groups if groups.max() < MANY else self.door

    def without(self, points: BoolArray) -> Self:
        """The same doors less some points, shape (n,)."""
        doors = []
        for number, door in enumerate(self.doors):
            gone = self.points.row[points & (self.door == number)]
            doors.append(replace(door, points=door.points[~np.isin(door.points.row, gone)]))
        return type(self)(doors, self.robot, self.tool, self.discrepancies)

    @property
    def off(self) -> float:
        """How far the walls are off beside what the springs make, root mean square [m]."""
        return root_mean_square(self.measured - self.case.springs())

    def excess(self, members: Sequence[InTime], theta: FloatArray) -> float:
        """What a model leaves beyond noise beside places, mill and discrepancy, mean square in standard deviations.

        Args:
            members: Of the model.
            theta: Its numbers, shape (p,).
        """
        return float(np.mean(self.predict(members, theta).cost)) - 1.0

    def beside(self, *discrepancies: Discrepancy) -> Self:
        """The same doors with other discrepancies, or none."""
        return type(self)(self.doors, self.robot, self.tool, discrepancies)

    def placed_by(self, members: Sequence[InTime], theta: FloatArray) -> Self:
        """The same doors, the scatter of their places taken from what a model leaves instead of what springs do.

        Args:
            members: Of the model.
            theta: Its numbers, shape (p,).
        """
        other = copy(self)
        other._unexplained = (self.measured - moved(self.case, members, theta)[0]) / self.noise
        other.door_places = other._places()
        other.nuisance = other._nuisance()
        return other

    def changed_at(self, steps: tuple[int, ...]) -> Self:
        """The same doors, with the numbers of those from which on something may have changed."""
        other = copy(self)
        other.steps = steps
        other.nuisance = other._nuisance()
        return other

    def _places(self) -> DoorPlaces:
        # Twice, for it takes the root of what a discrepancy can make.
        columns, alike = self._alike
        shown = Nuisance(columns, np.zeros((len(self), 0)), alike)
        left = shown.take(shown.take(self._unexplained[:, None]))[:, 0]
        return door_places(self.doors, self.door, self.points, self.noise, left)

    def _nuisance(self) -> Nuisance:
        """Places of the doors and surfaces of the mill; its face anew from each step on."""
        wall = self.points.wall
        mill = np.column_stack([FLANK * wall, FACE * ~wall]) / self.noise[:, None]
        after = [mill[:, 1] * (self.door >= step) for step in self.steps]
        columns, alike = self._alike
        known = np.column_stack([self.door_places.known, mill, *after, columns])
        return Nuisance(known, self.door_places.free, alike)

    def effects(self) -> list[Effect]:
        """Everything that may be wrong, whatever its course."""
        warming = len(self.doors) >= DOORS_OVER_TIME and bool(np.ptp(self.case.time) > _WARMING)
        kinds, tools = (list(dict.fromkeys(names.tolist())) for names in (self.points.kind, self.points.tool))
        return effects(kinds, tools, self.points.q, warming, self.places)

    @cached_property
    def places(self) -> int:
        """In how many places of the cell features were milled."""
        labels = np.char.add(np.char.add(self.door.astype(str), " "), self.points.feature)
        return places_of([self.points.point[labels == label].mean(axis=0) for label in np.unique(labels)])

    def courses(self) -> list[SizeCourse]:
        """How sizes may go over the doors, given the steps that are in question."""
        times = [door.time for door in self.doors]
        found = [SizeCourse()]
        if len(self.doors) < DOORS_OVER_TIME:
            return found
        over = times[0], times[-1]
        kinds = (
            (BEGINS, "from"),
            (CHANGES, "changed from"),
            (WEARS_AND_CHANGES, "drifting, changed from"),
        )
        for step in self.steps:
            for kind, word in kinds[: 1 if self.few_others else None]:
                found.append(SizeCourse(kind, times[step], *over, words=f"{word} {self.doors[step].name} on"))
        return [*found, *(SizeCourse(kind, times[0], *over, words="drifting") for kind in (DRIFTS, GROWS))]

    @property
    def few_others(self) -> bool:
        """Whether they are just enough for a change, and no two alike: what is left may pass for one then."""
        return len({door.recipe for door in self.doors}) == len(self.doors) == DOORS_OVER_TIME

    def candidates(self) -> list[InTime]:
        """Every effect with every course that it may have."""
        courses = self.courses()
        return [
            InTime(effect, course)
            for effect in self.effects()
            for course in courses
            if self._may_go(effect, course)
        ]

    def _may_go(self, effect: Effect, course: SizeCourse) -> bool:
        """Whether a course is one that an effect may have: of what a discrepancy could be only what was added."""
        added = any(one.could_be(effect) for one in self.discrepancies) and not effect.drifts
        if course.kind == ALWAYS:
            return not added
        if course.kind == GROWS:
            return added and DRIFTS in effect.courses
        return course.kind in ((BEGINS,) if added else effect.courses) and course.kind in effect.courses

    def predict(self, members: Sequence[InTime], theta: FloatArray, derivative: bool = False) -> Prediction:
        """Residuals, likelihood and derivatives of a model, as `Problem.predict`."""
        displaced, case = moved(self.case, members, theta)
        white = self.nuisance.take(((self.measured - displaced) / self.noise)[:, None])
        cost = np.sum(white**2, axis=1)
        residual = self.measured_part(white)
        if not derivative:
            return Prediction(residual, white, cost)
        derived = np.empty((len(self), len(theta)))
        of_load = np.array([m.effect.of_load for m in members for _ in range(m.size)], dtype=bool)
        derived[:, of_load] = by_load(self.case, members, theta, np.flatnonzero(of_load))
        others = [member.derivative(case) for member in members if not member.effect.of_load]
        derived[:, ~of_load] = np.hstack([np.zeros((len(self), 0)), *others])
        columns = self.nuisance.take(derived / self.noise[:, None])
        return Prediction(residual, white, cost, columns[:, None])

    def derivative_alone(self, cause: InTime) -> FloatArray:
        """Derivative by one effect alone in standard deviations, places not yet taken from it, shape (n, p)."""
        if not cause.effect.of_force:
            return cause.derivative(self.case) / self.noise[:, None]
        return by_load(self.case, [cause], np.zeros(cause.size), np.arange(cause.size)) / self.noise[:, None]

    def slope(self, cause: InTime, theta: FloatArray) -> FloatArray:
        """Whitened derivative by one effect alone, shape (n, 1, p)."""
        return self.predict([cause], theta, derivative=True).derived

    def measured_part(self, white: FloatArray) -> FloatArray:
        """Residual along the normals, shape (n, 1) [m], of a whitened one."""
        return white * self.noise[:, None]

    def bent(self) -> Self | None:
        """Process forces are too small for that."""
        return None

    def cuts(self) -> dict[str, BoolArray]:
        """Early and late doors, small and large loads, walls and floors, ways of the normal, heights; shape (n,)."""
        force = np.linalg.norm(self.case.load.force, axis=1)
        height, time = self.points.point[:, 2], self.case.time
        cuts = {
            "time": time > np.median(time),
            "load": force > np.median(force),
            "surface": self.points.wall,
            "normal left or right": self.points.normal[:, 1] > 0.0,
            "normal up or down": self.points.normal[:, 2] > 0.0,
            "height": height > np.median(height),
        }
        for kind in np.unique(self.points.kind):
            cuts[f"kind {kind}"] = self.points.kind == kind
        return {name: half for name, half in cuts.items() if 0.1 <= half.mean() <= 0.9}

    def objections(self, members: Sequence[InTime], theta: FloatArray, cause: InTime) -> Sequence[Check]:
        """That it moves the points by hardly more than mill and drifts are known to: anything could be that small."""
        return [moves_enough(self.case, self.resolution, members, theta, cause)]

    def groupings(self) -> Sequence[IntArray]:
        """What is left out together, and doors; shape (n,)."""
        return self.configuration, self.door

    def turning(self, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
        """Along one normal nothing points anywhere."""
        return "", 1.0

    def labels(self) -> IntArray:
        """Points, counted from 1 in the order of the doors, shape (n,)."""
        return np.arange(1, len(self) + 1)


#: What is known of milled doors.
DoorDiagnosis = Diagnosis[DoorProblem, InTime]
