"""Effects that move points without any load: tool, camera, clamp, heat."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect, Unloaded
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.warmth.growth import REACH
from doormill_ros.units import UM

_SECONDS_PER_HOUR = 3600.0
_SLOPE = 1e-4  #: of a shift that changes over the cell, at theta 1


class Shift(Unloaded):
    """Columns that geometry alone decides."""

    of_robot = False

    def __init__(
        self,
        name: str,
        where: str,
        parameters: tuple[CauseParameter, ...],
        columns: Callable[[CutCase], FloatArray],
        sentence: str,
        scale: list[float],
        report: Callable[[FloatArray], FloatArray] = np.array,
        rigid: bool = True,
        check: str = "",
    ) -> None:
        """Keep what it does.

        Args:
            name: Of the effect.
            where: Its place.
            parameters: As they are reported.
            columns: Along the normals for theta = 1, shape (n, p) [m].
            sentence: What it leaves.
            scale: Typical theta.
            report: Parameters of theta.
            rigid: Whether it displaces the tool or the door as a whole.
            check: What shows it without another door.
        """
        super().__init__(where)
        self.name, self.parameters, self.rigid, self.check = name, parameters, rigid, check
        self._columns, self._sentence, self._report = columns, sentence, report
        self.limit(scale)

    def pattern(self) -> str:
        """What it leaves."""
        return self._sentence

    def displacement(self, case: CutCase) -> FloatArray:
        """As it was given."""
        return self._columns(case)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Parameters in a row."""
        return np.asarray(self._report(theta), dtype=float)


def _translations(case: CutCase) -> FloatArray:
    """The door moved along base y and z after it was looked at: the tool is as much on the other side of it."""
    return -UM * case.normal[:, 1:]


def _camera(case: CutCase) -> FloatArray:
    arm = case.load.point - case.eye
    turned = -UM * case.along(np.cross(np.eye(3)[0], arm))
    return np.column_stack([_translations(case), turned])


def _from_base(case: CutCase) -> FloatArray:
    """Points pushed away from the robot's base."""
    away = case.load.point
    result: FloatArray = UM * case.along(away / np.linalg.norm(away, axis=1, keepdims=True))
    return result


def _place(case: CutCase) -> FloatArray:
    """A displacement that changes linearly with the place in the cell: what no one cause leaves."""
    place = case.load.point - case.load.point.mean(axis=0)
    slopes: FloatArray = _SLOPE * np.einsum("ni,nj->nij", case.normal, place).reshape(len(case), 9)
    return slopes


def _tilt(case: CutCase) -> FloatArray:
    """Depth of the doors, and turns about base y and z: what a picture from the front does not show."""
    arm = case.load.point - case.load.point.mean(axis=0)
    turned = [_SLOPE * case.along(np.cross(axis, arm)) for axis in np.eye(3)[1:]]
    return np.column_stack([_SLOPE * case.normal[:, 0], *turned])


class Place(Shift):
    """A displacement that is another one at every place of the cell; no cause, but many together leave it."""

    named = False
    courses = ()

    def __init__(self) -> None:
        """Nine slopes."""
        super().__init__(
            "place_dependent_shift", "cell", (), _place, "a shift that changes over the cell", [1.0] * 9
        )


class Tilt(Shift):
    """Doors that lean out of the camera's picture plane, which it does not see; no cause, but a clamp may leave it."""

    named = False
    courses = (BEGINS,)

    def __init__(self) -> None:
        """Depth, and turns about y and z."""
        super().__init__("door_tilt", "clamp", (), _tilt, "doors that lean in their clamp", [1.0] * 3)


class Warming(Unloaded):
    """Growth away from the base that comes to rest with a time constant; theta is its end [um]."""

    name = "thermal_growth"
    check = "mill one door cold and the same door after an hour of work"
    of_robot = False
    courses = ()
    drifts = True
    rigid = True
    parameters = (CauseParameter("growth", "m", 0.0, 1e-2), CauseParameter("hours", "1", 0.0, 100.0))

    def __init__(self, hours: float) -> None:
        """Time constant [h]."""
        super().__init__("cell")
        self.hours, self.variant = hours, f"{hours:g} h"
        self.limit([50.0], 0.0)

    def pattern(self) -> str:
        """What it leaves."""
        return "the tool comes further forward from door to door, ever more slowly"

    def displacement(self, case: CutCase) -> FloatArray:
        """Since the first door."""
        hours = (case.time - case.time.min()) / _SECONDS_PER_HOUR
        moved: FloatArray = self._way(case) * (1.0 - np.exp(-hours / self.hours))
        return moved[:, None]

    def _way(self, case: CutCase) -> FloatArray:
        """Of the points in the end, for theta = 1, shape (n,) [m]."""
        return _from_base(case)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """Growth in the end, and the hours."""
        return np.array([UM * theta[0], self.hours])


class ArmWarming(Warming):
    """All lengths of the arm grow by one share, the tool's aside: theta is its end [um] with the flange at REACH."""

    def __init__(self, hours: float) -> None:
        """Time constant [h]."""
        super().__init__(hours)
        self.variant = f"{hours:g} h, the whole arm"

    def pattern(self) -> str:
        """What it leaves."""
        return "the tool comes the further forward the farther the arm reaches, from door to door ever more slowly"

    def _way(self, case: CutCase) -> FloatArray:
        result: FloatArray = UM / REACH * case.along(case.load.origin[:, 6])
        return result


_METRES, _RADIANS = ("m", -0.1, 0.1), ("rad", -0.1, 0.1)


def _scaled(theta: FloatArray) -> FloatArray:
    return UM * theta


def shifts(mills: Sequence[str]) -> list[Effect]:
    """Effects of camera and clamp, and of mills: TOOL for all of them alike, or the name of one."""
    return [
        Shift(
            "camera_shift",
            "camera",
            (CauseParameter("translation", *_METRES, 2), CauseParameter("rotation", *_RADIANS)),
            _camera,
            "all doors are milled displaced and turned in the picture's plane by the same amount",
            [50.0, 50.0, 50.0],
            report=_scaled,
            check="picture a door whose edges were probed in the clamp",
        ),
        Shift(
            "clamp_shift",
            "clamp",
            (CauseParameter("translation", *_METRES, 3),),
            lambda case: -UM * case.normal,
            "all doors are milled displaced by the same amount",
            [50.0] * 3,
            report=_scaled,
            check="picture a door in the clamp before and after milling",
        ),
        *(_of_tool("tool_radius", where, True) for where in mills),
        *(_of_tool("tool_length", where, False) for where in mills),
    ]


def _of_tool(name: str, where: str, walls: bool) -> Shift:
    """What cuts walls or floors too deep."""
    return Shift(
        name,
        where,
        (CauseParameter("offset", *_METRES),),
        lambda case: UM * (case.cut_by(where) & (case.wall == walls))[:, None].astype(float),
        "all walls are displaced into the wood or out of it by the same amount"
        if walls
        else "all floors are too deep or too high by the same amount",
        [20.0],
        report=_scaled,
        rigid=not walls,
        check="measure the mill, or mill a groove of its width"
        if walls
        else "measure the length of the mill",
    )
