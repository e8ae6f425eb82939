"""Where the door, the tool and the robot stand in the cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import StrictBool

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.places.backing import Backing, Board
from doormill_ros.cell.places.gravity import Gravity
from doormill_ros.cell.places.rack import Rack, check_rack
from doormill_ros.config import read
from doormill_ros.frames import inverse, rotation_x, transform
from doormill_ros.resources import resource
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.description import Joints
from doormill_ros.values import Finite, Name, NotNegative, Positive, Section, Vector3

FORM = "config/cell.yaml"
CAMERA = "camera"  #: the sensor that every cell has unless its file names others


@dataclass(frozen=True)
class DoorOffset:
    """Displacement of the door from its nominal place.

    Attributes:
        y: Along base y [m].
        z: Along base z [m].
        rotation: About base x, at the door origin [rad].
    """

    y: float = 0.0
    z: float = 0.0
    rotation: float = 0.0


#: What a door's displacement is in, as `DoorOffset` names it [m, m, rad].
OFFSETS = ("y", "z", "rotation")


class Slack(NamedTuple):
    """What the error of its measurement may add to the offset of a door that stands at the very limit [m, rad]."""

    position: float
    rotation: float


#: Of the camera alone: what is left of a picture's noise, for /door_localizer, which knows that it measured.
CAMERA_SLACK = Slack(2e-5, 3.5e-4)
#: Of any sensor, for the path generator, which does not know whose pose it has: the covariance of the touch probe, the
#: worst of them, allows for 0.4 mm (docs/sensors.md), over points that are 0.2 m apart. No less than the camera's, or
#: doors that the localizer let pass would be refused here.
SENSOR_SLACK = Slack(5e-4, 2e-3)


@dataclass(frozen=True)
class PlacementLimits(Section):
    """Largest absolute door offset that the cell accepts: y, z [m], rotation [rad]."""

    y: NotNegative
    z: NotNegative
    rotation: NotNegative

    def beyond(self, offset: DoorOffset, slack: Slack) -> tuple[str, ...]:
        """In which of `OFFSETS` a door stands further off than its limit and the slack of who measured it."""
        slacks = (slack.position, slack.position, slack.rotation)
        return tuple(
            name
            for name, more in zip(OFFSETS, slacks, strict=True)
            if abs(getattr(offset, name)) - getattr(self, name) > more
        )


@dataclass(frozen=True, eq=False)
class CellLayout:
    """Fixture, tool and robot of one cell.

    Attributes:
        robot: Name of the robot description.
        rear_face_x: x of the door's rear face in the clamp [m].
        centre_y: y on which doors stand centred [m].
        bottom_z: z of the door's bottom edge [m].
        limits: Accepted door offsets.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        home: Where every program begins and ends, shape (6,) [rad].
        spindle: What is bolted to the flange, flange frame.
        obstacles: What stands in the cell beside robot and door, base frame.
        with_second: What stands about a second robot, where there is one, in its base frame.
        clearance: Kept between any two bodies that must not touch, outside the cut [m].
        gravity: Whose weight moves the targets.
        boards: What backs the rear face of a door.
        sensors: What finds the door, by name; the first one's pose is used for milling.
        rack: Where tools stand that the robot takes by itself.
        rack_of_second: Where those of a second robot stand, by that robot's joint angles.
    """

    robot: str
    rear_face_x: float
    centre_y: float
    bottom_z: float
    limits: PlacementLimits
    T_flange_tool: FloatArray
    home: FloatArray
    spindle: tuple[Body, ...]
    obstacles: tuple[Body, ...]
    clearance: float
    gravity: Gravity = field(default_factory=Gravity)
    boards: tuple[Board, ...] = ()
    sensors: tuple[str, ...] = (CAMERA,)
    rack: Rack | None = None
    with_second: tuple[Body, ...] = ()
    rack_of_second: Rack | None = None

    def T_base_door(self, width: float, thickness: float, offset: DoorOffset | None = None) -> FloatArray:
        """Door frame in the base frame, shape (4, 4).

        Args:
            width: Door width [m].
            thickness: Door thickness [m].
            offset: Displacement from the nominal place; None for the nominal place.
        """
        offset = offset or DoorOffset()
        origin = np.array(
            [
                self.rear_face_x - thickness,
                self.centre_y - width / 2.0 + offset.y,
                self.bottom_z + offset.z,
            ]
        )
        return transform(rotation_x(offset.rotation), origin)

    def seen_from(self, T_base_other: FloatArray) -> CellLayout:
        """The cell as another robot of the kind sees it, its tool and home the same; it has the rack of a second robot.

        Args:
            T_base_other: The other robot's base frame, shape (4, 4).
        """
        T_other_base = inverse(T_base_other)
        obstacles = tuple(body.mapped(T_other_base) for body in self.obstacles)
        return replace(self, obstacles=obstacles, rack=self.rack_of_second)

    def beside(self, bodies: Sequence[Body]) -> CellLayout:
        """The cell with further bodies that stand in it, in this robot's base frame."""
        return replace(self, obstacles=(*self.obstacles, *bodies))

    def with_rear_free(self) -> CellLayout:
        """The cell with its boards away, for a second robot that mills the rear face."""
        return replace(self, boards=())

    def of_two(self, T_base_second: FloatArray) -> CellLayout:
        """The cell where a second robot stands, its base frame of shape (4, 4): rear face free, its obstacles there."""
        return self.with_rear_free().beside([body.mapped(T_base_second) for body in self.with_second])

    def offset_of(self, T_base_door: FloatArray, width: float) -> DoorOffset:
        """The three free degrees of freedom of a door pose, shape (4, 4); inverse of `T_base_door`."""
        return DoorOffset(
            y=float(T_base_door[1, 3] - (self.centre_y - width / 2.0)),
            z=float(T_base_door[2, 3] - self.bottom_z),
            rotation=float(np.arctan2(T_base_door[2, 1], T_base_door[1, 1])),
        )


@dataclass(frozen=True)
class _Fixture(Section):
    rear_face_x: Finite
    centre_y: Finite
    bottom_z: Finite


@dataclass(frozen=True, eq=False)
class _Tool(Section):
    position: Vector3
    measured: StrictBool = False


@dataclass(frozen=True, eq=False)
class _Home(Section):
    joints: Joints
    source: Name
    measured: StrictBool


@dataclass(frozen=True, eq=False)
class _Spindle(Section):
    source: Name
    measured: StrictBool
    bodies: tuple[Body, ...]


@dataclass(frozen=True, eq=False)
class _SecondRobot(Section):
    obstacles: tuple[Body, ...]
    rack: Rack | None = None


@dataclass(frozen=True, eq=False)
class _CellFile(Section):
    robot: Name
    fixture: _Fixture
    placement_limits: PlacementLimits
    tool: _Tool
    home: _Home
    spindle: _Spindle
    obstacles: tuple[Body, ...]
    clearance: Positive
    gravity: Gravity = field(default_factory=Gravity)
    backing: Backing | None = None
    sensors: tuple[Name, ...] = (CAMERA,)
    rack: Rack | None = None
    second_robot: _SecondRobot | None = None


def load_layout(path: Path | None = None) -> CellLayout:
    """Read config/cell.yaml, or another file of the same form.

    Raises:
        BadCellFile: A key is missing or unknown, or a value impossible.
    """
    content = read(path or resource(FORM), _CellFile, BadCellFile, f"compare it with {FORM}")
    T_flange_tool = transform(translation=content.tool.position)
    T_flange_tool.setflags(write=False)
    second = content.second_robot or _SecondRobot(())
    return CellLayout(
        robot=content.robot,
        rear_face_x=content.fixture.rear_face_x,
        centre_y=content.fixture.centre_y,
        bottom_z=content.fixture.bottom_z,
        limits=content.placement_limits,
        T_flange_tool=T_flange_tool,
        home=content.home.joints,
        spindle=content.spindle.bodies,
        obstacles=content.obstacles,
        clearance=content.clearance,
        gravity=content.gravity,
        boards=() if content.backing is None else content.backing.boards,
        sensors=content.sensors,
        rack=check_rack(content.rack),
        with_second=second.obstacles,
        rack_of_second=check_rack(second.rack, "second_robot.rack"),
    )
