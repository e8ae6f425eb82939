"""What a configuration must keep to along a path, and what to say when none does."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot.description import Robot
from doormill_ros.robot.errors import (
    BranchError,
    JointLimitError,
    RobotError,
    SingularityError,
    UnreachableError,
)
from doormill_ros.robot.singularity import Clearance
from doormill_ros.units import DEG, rad_to_deg


@dataclass(frozen=True)
class BranchRules:
    """What a configuration must keep to along the path.

    Attributes:
        limit_margin: Distance of every joint from its limits [rad].
        wrist: Smallest angle of axis 5 from straight [rad].
        elbow: Smallest angle of the forearm from in line with the lower arm [rad].
        shoulder: Smallest distance of the wrist centre from axis 1 [m].
        max_step: Largest move of a joint between neighbouring poses [rad].
        equal_compliance: Ratio up to which two candidates count as equally stiff; the one farther
            from its limits, or nearer to the start, then wins.
    """

    limit_margin: float = 1.0 * DEG
    wrist: float = 5.0 * DEG
    elbow: float = 5.0 * DEG
    shoulder: float = 0.1
    max_step: float = 90.0 * DEG
    equal_compliance: float = 1.02


@dataclass(eq=False)
class Rejected:
    """Why candidates failed, with the one that came closest for the message."""

    limits: list[tuple[float, int, int]] = field(default_factory=list)
    rolls: list[tuple[float, int, int]] = field(default_factory=list)
    singular: list[tuple[str, int]] = field(default_factory=list)
    steps: list[tuple[float, int, int]] = field(default_factory=list)


def too_close(found: Clearance, rules: BranchRules, first: int) -> tuple[str, int] | None:
    """What comes closer to a singularity than the rules allow, and at which pose; None if nothing."""
    for name, values, allowed, unit in (
        ("axis 5 is", rad_to_deg(found.wrist), rad_to_deg(rules.wrist), "deg from straight"),
        ("the elbow is", rad_to_deg(found.elbow), rad_to_deg(rules.elbow), "deg from stretched"),
        ("the wrist centre is", found.shoulder, rules.shoulder, "m from axis 1"),
    ):
        at = int(values.argmin())
        if values[at] < allowed:
            return f"{name} {values[at]:.3g} {unit}, allowed is {allowed:.3g}", first + at
    return None


def check_reach(robot: Robot, T_base_flange: FloatArray, solutions: FloatArray) -> None:
    """Raise UnreachableError for the first pose that no branch reaches, solutions (n, 8, 6)."""
    lost: BoolArray = np.all(np.isnan(solutions[..., 0]), axis=1)
    if lost.any():
        at = int(lost.argmax())
        x, y, z = T_base_flange[at, :3, 3]
        raise UnreachableError(
            f"{robot.label} cannot reach pose {at + 1} of {len(lost)} of the path, flange at "
            f"({x:.3f}, {y:.3f}, {z:.3f}) m; move the work or the robot",
            pose=at,
        )


def refusal(robot: Robot, rejected: Rejected, rules: BranchRules, n: int, first: int) -> RobotError:
    """The error that says why `n` poses from `first` on have no configuration."""
    where = f"poses {first + 1} to {first + n}"
    if rejected.singular and not rejected.rolls:
        reason, at = rejected.singular[0]
        return SingularityError(
            f"{robot.label} passes too close to a singularity on {where}: at pose {at + 1} {reason}; "
            "move the work sideways or the robot's foot",
            pose=at,
        )
    if rejected.steps:
        step, at, joint = min(rejected.steps)
        return BranchError(
            f"{robot.label} keeps no configuration on {where}: joint {joint + 1} moves "
            f"{rad_to_deg(step):.0f} deg after pose {at + 1}, allowed is {rad_to_deg(rules.max_step):.0f}; "
            "add poses between or allow a change",
            pose=at,
        )
    if rejected.rolls or rejected.limits:
        over, joint, at = min(rejected.rolls or rejected.limits)
        return JointLimitError(
            f"{robot.label} reaches {where} only with joint {joint + 1} {rad_to_deg(over):.2f} deg "
            f"beyond its range of {rad_to_deg(robot.lower[joint]):.0f} to "
            f"{rad_to_deg(robot.upper[joint]):.0f} deg less {rad_to_deg(rules.limit_margin):.1f} deg; "
            "move the work or the robot",
            pose=at,
            joint=joint + 1,
        )
    return BranchError(
        f"{robot.label} reaches every one of {where}, but no branch reaches them all; split the path"
    )
