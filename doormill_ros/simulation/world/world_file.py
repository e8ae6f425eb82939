"""The world file, schema doormill/world/1: in what the simulated cell differs from what the project assumes.

Whatever is left out is as the project assumes. Doors of a shift are counted from 0. An entry of `change` replaces, from
its door on, the keys that it holds and leaves the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import model_validator

from doormill_ros.arrays import FloatArray
from doormill_ros.config import check, read_document
from doormill_ros.simulation.errors import WorldFileError
from doormill_ros.values import (
    Exactly,
    Finite,
    FiniteNumber,
    NotNegative,
    Positive,
    Section,
    Vector3,
    contradiction,
)

SCHEMA = "doormill/world/1"
ADVICE = "compare it with docs/world.md"
JOINTS = 6

Number = Annotated[int, FiniteNumber("a whole number from 0 up", 0.0, whole=True)]
SixPositive = tuple[Positive, Positive, Positive, Positive, Positive, Positive]
SixNotNegative = tuple[NotNegative, NotNegative, NotNegative, NotNegative, NotNegative, NotNegative]


def _nothing() -> FloatArray:
    return np.zeros(3)


@dataclass(frozen=True)
class GeometryErrors(Section):
    """Errors of the robot's table of links.

    Attributes:
        seed: Of the drawing.
        size: Root mean square of the errors of the lengths [m]; that of the angles is the angle that makes as much
            over one metre.
    """

    seed: Number = 0
    size: NotNegative = 0.0


@dataclass(frozen=True)
class RobotOfWorld(Section):
    """Springs, gaps and links of the robot.

    Attributes:
        stiffness_factor: Times the stiffness of each joint.
        gap: Backlash of each joint [rad].
        crossing: Torque at which a gap is fully crossed [N m]; 0 for a step.
        pose_error: Errors of the links.
    """

    stiffness_factor: SixPositive = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    gap: SixNotNegative = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    crossing: NotNegative = 0.0
    pose_error: GeometryErrors = GeometryErrors()


@dataclass(frozen=True, eq=False)
class ToolOfWorld(Section):
    """Spindle with mill.

    Attributes:
        mass: 0 for no gravity [kg].
        com: Centre of mass, flange frame, shape (3,) [m].
        stiffness: Against forces across the tool at its tip [N / m]; None for rigid.
    """

    mass: NotNegative = 0.0
    com: Vector3 = field(default_factory=_nothing)
    stiffness: Positive | None = None


@dataclass(frozen=True)
class LinksOfWorld(Section):
    """Masses of the links from the first one on [kg]; of those not named there is no gravity."""

    masses: tuple[NotNegative, ...] = ()

    @model_validator(mode="after")
    def _as_many_as_links(self) -> LinksOfWorld:
        if len(self.masses) > JOINTS:
            raise contradiction(
                f"links.masses holds {len(self.masses)} numbers, allowed are at most {JOINTS}, one a link"
            )
        return self


@dataclass(frozen=True)
class ForceOfWorld(Section):
    """What the wood does to the tool.

    Attributes:
        law: "recipe": what the targets were corrected for; "engagement": what the engaged wood makes.
        factor: Times that.
        angle: Turns it about the tool axis [rad].
        wear_per_door: Share of the factor that each door before this one added.
        scatter: Standard deviation of a factor drawn for each door.
    """

    law: Literal["recipe", "engagement"] = "recipe"
    factor: NotNegative = 1.0
    angle: Finite = 0.0
    wear_per_door: Finite = 0.0
    scatter: NotNegative = 0.0


@dataclass(frozen=True, eq=False)
class CameraOfWorld(Section):
    """How far the camera is from where its calibration has it.

    Attributes:
        moved: Base axes, shape (3,) [m].
        turned: Rotation vector, base axes, shape (3,) [rad].
        from_door: First door that it holds for.
    """

    moved: Vector3 = field(default_factory=_nothing)
    turned: Vector3 = field(default_factory=_nothing)
    from_door: Number = 0


@dataclass(frozen=True, eq=False)
class ClampOfWorld(Section):
    """How far the clamp moves the door after its picture was taken.

    Attributes:
        shift: Base axes, shape (3,) [m].
        from_door: First door that it holds for.
    """

    shift: Vector3 = field(default_factory=_nothing)
    from_door: Number = 0


@dataclass(frozen=True)
class TemperatureOfWorld(Section):
    """The arm warms up from the first door on.

    Attributes:
        rise: In the end [K].
        hours: Time in which all but 1 / e of it has come [h].
        growth: Of the way from the robot's base to its tool [m / K].
        expansion: Of all lengths of the arm [1 / K].
    """

    rise: Finite = 0.0
    hours: Positive = 2.0
    growth: Finite = 0.0
    expansion: Finite = 0.0


@dataclass(frozen=True)
class ControllerOfWorld(Section):
    """The real controller; None as config/controller.yaml.

    Attributes:
        segment_time: Shortest time of a motion [s].
        corner: How far it cuts a right angle that it passes without a stop [m], beside the programmed zone.
        lag: Time constant with which the tool follows [s].
        acceleration: Of the tool [m/s^2].
    """

    segment_time: NotNegative | None = None
    corner: NotNegative = 0.0
    lag: NotNegative = 0.0
    acceleration: Positive | None = None


@dataclass(frozen=True, eq=False)
class DoorWorld(Section):
    """The world in which one door is milled."""

    robot: RobotOfWorld = RobotOfWorld()
    tool: ToolOfWorld = field(default_factory=ToolOfWorld)
    links: LinksOfWorld = LinksOfWorld()
    force: ForceOfWorld = ForceOfWorld()
    camera: CameraOfWorld = field(default_factory=CameraOfWorld)
    clamp: ClampOfWorld = field(default_factory=ClampOfWorld)
    temperature: TemperatureOfWorld = TemperatureOfWorld()
    controller: ControllerOfWorld = ControllerOfWorld()


@dataclass(frozen=True, eq=False, kw_only=True)
class _Change(DoorWorld):
    from_door: Number


@dataclass(frozen=True, eq=False, kw_only=True)
class _File(DoorWorld):
    schema: Annotated[str, Exactly(SCHEMA)]
    seed: Number = 0
    change: tuple[_Change, ...] = ()


@dataclass(frozen=True, eq=False)
class ShiftWorld:
    """A world as its file describes it.

    Attributes:
        name: The file.
        seed: Of everything that is drawn.
    """

    name: str = ""
    seed: int = 0
    _base: Mapping[str, Any] = field(default_factory=dict)
    _changes: tuple[Mapping[str, Any], ...] = ()

    def door(self, number: int) -> DoorWorld:
        """What holds for a door of the shift, the first one is 0.

        Raises:
            WorldFileError: Changes that each are allowed make together what is not.
        """
        document = dict(self._base)
        for change in self._changes:
            if number >= change["from_door"]:
                document = _merged(document, {k: v for k, v in change.items() if k != "from_door"})
        return check(document, DoorWorld, WorldFileError, self.name, ADVICE)


def load_world(path: Path) -> ShiftWorld:
    """A world from its file.

    Raises:
        WorldFileError: No such file, or a key or value that is not allowed.
    """
    document = read_document(path, WorldFileError, ADVICE)
    file = check(document, _File, WorldFileError, str(path), ADVICE)
    base = {key: value for key, value in document.items() if key not in ("schema", "seed", "change")}
    return ShiftWorld(str(path), file.seed, base, tuple(document.get("change", ())))


def _merged(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """The old mapping with the values of the new one; mappings in it likewise."""
    both = dict(old)
    for key, value in new.items():
        known = both.get(key)
        both[key] = (
            _merged(known, value) if isinstance(known, Mapping) and isinstance(value, Mapping) else value
        )
    return both
