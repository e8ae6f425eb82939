"""How doors are milled: the values of config/toolpath.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeVar

from pydantic.dataclasses import dataclass

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.rapid_limits import MAX_TARGETS
from doormill_ros.config import read
from doormill_ros.frames import rotation_z, transform
from doormill_ros.recipes.features.registry import time_budgets
from doormill_ros.resources import resource
from doormill_ros.toolpath.errors import PathSettingsError
from doormill_ros.values import Count, Finite, FiniteNumber, NotNegative, Positive, Section, Vector3

FORM = "config/toolpath.yaml"
Kind = TypeVar("Kind", bound=type)


@dataclass(frozen=True)
class Approach(Section):
    """Motions in the air.

    Attributes:
        clearance: Tool tip in front of the surface between features [m].
        edge_clearance: The same while the spindle swings from one side of the door to another [m].
        retreats: How far to draw back, one after the other, where the straight way close to the
            door is not possible [m].
        way_speed: Speed from home, between features and home again [m/s].
        rapid_speed: Speed in the air in front of a feature [m/s].
        plunge_speed: Speed of the way down to the wood [m/s].
        nose: How far the mill reaches out of the spindle or its holder [m].
        mill_radius: Of a mill, at least; what must not touch is as wide as the widest that the door takes [m].
    """

    clearance: Positive
    edge_clearance: Positive
    retreats: tuple[Positive, ...]
    way_speed: Positive
    rapid_speed: Positive
    plunge_speed: Positive
    nose: Positive
    mill_radius: Positive


@dataclass(frozen=True)
class Correction(Section):
    """Limits of the process force correction.

    Attributes:
        limit: Largest translation between nominal and corrected pose, for the process force [m].
        standing: The same for what the unloaded tool is off by, where the model knows of it [m].
        unmeasured: The same where nobody measured the force [m].
        tolerance: Accepted distance of the loaded tool from the nominal pose [m].
        bend: A segment is divided where it would leave its exact path by more [m].
        blend: Length over which the wrench of one segment becomes that of the next [m].
        step: A change of wrench that moves the correction by more is blended [m].
        segment_time: Shortest time of a motion at its feed [s].
    """

    limit: Positive
    standing: Positive
    unmeasured: Positive
    tolerance: Positive
    bend: Positive
    blend: Positive
    step: Positive
    segment_time: Positive


@dataclass(frozen=True)
class Checks(Section):
    """Limits of the whole-door checks.

    Attributes:
        targets: Most targets of a program; the controller keeps no more than `MAX_TARGETS`.
        tools: Most tools of a door that takes none of the rack.
        tool_length: How much longer or shorter than `approach.nose` a tool of the table may stand out [m].
        joint_margin: Distance kept from each joint limit [rad].
        wrist: Smallest angle of axis 5 from straight [rad].
        elbow: Smallest angle of the forearm from in line with the lower arm [rad].
        shoulder: Smallest distance of the wrist centre from axis 1 [m].
        joint_speed_share: Allowed share of the joints' speed limits.
        expected_error: Largest expected error of a wall [m].
    """

    targets: Annotated[
        int, FiniteNumber(f"a whole number from 1 to {MAX_TARGETS}", 1.0, MAX_TARGETS, whole=True)
    ]
    tools: Count
    tool_length: Positive
    joint_margin: Positive
    wrist: Positive
    elbow: Positive
    shoulder: Positive
    joint_speed_share: Positive
    expected_error: Positive


def _with_budgets(section: Kind) -> Kind:
    """Give a section a key for each time budget that features name."""
    section.__annotations__.update({budget.name: "Positive" for budget in time_budgets()})
    return section


@dataclass(frozen=True)
@_with_budgets
class Cycle(Section):
    """Times on the controller, and those that appendix A.1 of the thesis allows; a key for each budget beside them.

    Attributes:
        acceleration: Of the tool centre point [m/s^2].
        joint_ramp: Time in which a joint reaches its largest speed [s].
        stop: Coming to rest and setting off again [s].
        spindle: From rest or one speed of the spindle to another [s].
        reading: Reading and checking one line of the target file [s].
        changing: Putting a tool into its place, or taking one out, from in front of it and back [s].
        measuring: Measuring a tool's length, likewise [s].
        same_spindle: Spindle speeds that differ by a smaller share are one speed.
        probing: Finding the door, with the camera [s].
        total: One door from clamp to clamp [s].
    """

    acceleration: Positive
    joint_ramp: Positive
    stop: NotNegative
    spindle: NotNegative
    reading: NotNegative
    changing: NotNegative
    measuring: NotNegative
    same_spindle: NotNegative
    probing: Positive
    total: Positive

    @property
    def budgets(self) -> dict[str, float]:
        """What features are allowed, by the name of their `TimeBudget` [s]."""
        return {budget.name: getattr(self, budget.name) for budget in time_budgets()}


@dataclass(frozen=True, eq=False)
class SecondRobot(Section):
    """Where the second milling robot stands.

    Attributes:
        position: Its base in the first robot's base frame, shape (3,) [m].
        rotation: About z [rad].
    """

    position: Vector3
    rotation: Finite

    @property
    def T_base_second(self) -> FloatArray:
        """Its base frame in the first robot's, shape (4, 4)."""
        return transform(rotation_z(self.rotation), self.position)


@dataclass(frozen=True)
class PathSettings(Section):
    """Everything in config/toolpath.yaml."""

    approach: Approach
    correction: Correction
    checks: Checks
    cycle: Cycle
    second_robot: SecondRobot


def load_settings(path: Path | None = None) -> PathSettings:
    """Read config/toolpath.yaml, or another file of the same form.

    Raises:
        PathSettingsError: A value is missing, unknown or impossible.
    """
    return read(path or resource(FORM), PathSettings, PathSettingsError, f"compare it with {FORM}")
