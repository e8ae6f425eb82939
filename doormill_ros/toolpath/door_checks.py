"""Look at a whole program before it is milled: margins, speeds and cycle times in one table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.recipes.features.registry import time_budgets
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.robot.singularity import clearance
from doormill_ros.toolpath.pacing.timing import feature_times, motion_times, program_time
from doormill_ros.toolpath.program import MillingProgram, MotionKind
from doormill_ros.toolpath.settings import PathSettings, load_settings
from doormill_ros.units import m_to_mm, rad_to_deg


@dataclass(frozen=True)
class FeatureCheck:
    """One feature of a program.

    Attributes:
        feature: Identifier in the recipe.
        targets: Number of targets.
        time: With the way to it from the feature before [s].
        correction: Largest translation between nominal and corrected pose [m].
        expected: Largest expected error of its walls [m].
        joint_margin: Smallest distance of any joint from its limits [rad].
        wrist: Smallest angle of axis 5 from straight [rad].
        elbow: Smallest angle of the forearm from in line with the lower arm [rad].
        shoulder: Smallest distance of the wrist centre from axis 1 [m].
    """

    feature: str
    targets: int
    time: float
    correction: float
    expected: float
    joint_margin: float
    wrist: float
    elbow: float
    shoulder: float


@dataclass(frozen=True)
class Budget:
    """A time that appendix A.1 of the thesis allows, and what the program takes [s]."""

    what: str
    found: float
    allowed: float

    @property
    def kept(self) -> bool:
        """True when the program is fast enough."""
        return self.found <= self.allowed

    def __str__(self) -> str:
        """A line for an operator."""
        word = "kept" if self.kept else "EXCEEDED"
        return f"{self.what}: {self.found:.1f} s of {self.allowed:.1f} s, {word}"


@dataclass(frozen=True)
class DoorCheck:
    """One robot's program looked at as a whole.

    Attributes:
        features: In the order of milling.
        budgets: Times against appendix A.1; the last one is the whole cycle with probing.
        time: The program from home to home, and reading it [s].
    """

    features: tuple[FeatureCheck, ...]
    budgets: tuple[Budget, ...]
    time: float


def check_door(
    program: MillingProgram, recipe: Recipe, robot: Robot, settings: PathSettings | None = None
) -> DoorCheck:
    """Margins of every feature, and the cycle time against appendix A.1.

    Args:
        program: One robot's program.
        recipe: What it was made from.
        robot: Who mills it.
        settings: Values of config/toolpath.yaml; None reads the file.
    """
    settings = settings or load_settings()
    times = motion_times(program, robot, settings.cycle)
    by_feature = feature_times(program, times)
    used: dict[str, set[int]] = {}
    for motion in program.motions:
        if motion.feature and motion.kind is not MotionKind.ABSOLUTE:
            places = {motion.target} if motion.via is None else {motion.target, motion.via}
            used.setdefault(motion.feature, set()).update(places)
    rows = [_feature_check(name, sorted(used[name]), by_feature[name], program, robot) for name in used]
    time = program_time(program, times, settings.cycle)
    return DoorCheck(tuple(rows), _budgets(by_feature, time, recipe, settings), time)


def cycle_budget(checks: Sequence[DoorCheck], settings: PathSettings | None = None) -> Budget:
    """The door's time, that of its slowest robot with probing, against appendix A.1.

    Args:
        checks: One of each robot that mills the door at the same time.
        settings: Values of config/toolpath.yaml; None reads the file.
    """
    cycle = (settings or load_settings()).cycle
    return Budget("door, with probing", max(check.time for check in checks) + cycle.probing, cycle.total)


def text_table(check: DoorCheck) -> str:
    """The check as lines for an operator; seconds, millimetres and degrees."""
    lines = [
        "feature              targets   time  corr.mm  exp.mm  limit.deg  wrist.deg  elbow.deg  shoulder.m"
    ]
    for row in check.features:
        lines.append(
            f"{row.feature:20.20s} {row.targets:7d} {row.time:6.1f} {m_to_mm(row.correction):8.3f}"
            f" {m_to_mm(row.expected):7.3f}"
            f" {rad_to_deg(row.joint_margin):10.1f} {rad_to_deg(row.wrist):10.1f}"
            f" {rad_to_deg(row.elbow):10.1f} {row.shoulder:11.2f}"
        )
    lines += [str(budget) for budget in check.budgets]
    return "\n".join(lines)


def _feature_check(
    name: str, used: Sequence[int], time: float, program: MillingProgram, robot: Robot
) -> FeatureCheck:
    targets = [program.targets[i] for i in used]
    q = np.array([t.q for t in targets])
    near = clearance(robot, q)
    step = np.array([(t.T_base_tool_corrected - t.T_base_tool_nominal)[:3, 3] for t in targets])
    return FeatureCheck(
        feature=name,
        targets=len(targets),
        time=time,
        correction=float(np.linalg.norm(step, axis=1).max()),
        expected=max(t.expected_error for t in targets),
        joint_margin=float(np.minimum(q - robot.lower, robot.upper - q).min()),
        wrist=float(near.wrist.min()),
        elbow=float(near.elbow.min()),
        shoulder=float(near.shoulder.min()),
    )


def _budgets(
    by_feature: dict[str, float], time: float, recipe: Recipe, settings: PathSettings
) -> tuple[Budget, ...]:
    cycle = settings.cycle
    kinds = {feature.id: feature for feature in recipe.features}
    budgets = []
    for budget in time_budgets():
        times = {name: own for name, own in by_feature.items() if kinds[name].budget == budget}
        allowed = cycle.budgets[budget.name]
        if not budget.words:
            budgets += [Budget(name, own, allowed) for name, own in times.items()]
        elif times:
            budgets.append(Budget(budget.words.format(count=len(times)), sum(times.values()), allowed))
    budgets.append(Budget("door, with probing", time + cycle.probing, cycle.total))
    return tuple(budgets)
