"""Shifts with hidden effects: drawn, milled by their worlds, diagnosed, and compared with what was hidden."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.diagnosis.parts.doors.recorded_cut import RecordedCut, recorded_cut
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis
from doormill_ros.diagnosis.parts.kind import InspectedDoor, Inspections, inspected_door
from doormill_ros.measurements.inspections.inspection import inspections_in
from doormill_ros.simulation.world.gauge import NOISE
from support.gauged_shift import HINGE_DOORS, gauged_shift

#: Doors by which a step may be found too early or too late.
NEAR = 3
#: Gauge noise that a hidden effect has to move walls and floors by, root mean square, to be owed.
OWED = 2.0
#: What may be hidden; a shift has one to three of them, or none.
EFFECTS = ("gap", "spring", "force", "angle", "bending", "camera", "clamp", "wear", "warming", "weight")


@dataclass(frozen=True)
class Hidden:
    """One effect of a world: its cause, where, and the first door that has it."""

    cause: str
    where: str
    from_door: int = 0


@dataclass(frozen=True)
class DrawnShift:
    """A world as its file has it, what is hidden in it, and the doors of the shift."""

    world: dict
    hidden: tuple[Hidden, ...]
    doors: tuple[str, ...]


@dataclass(frozen=True)
class Judged:
    """What was said of a shift.

    Attributes:
        verdict: Of the diagnosis.
        named: Cause, place and course of what was named.
        missed: What was hidden and neither named nor listed as confusable with what was.
        wrong: What was named although neither it nor anything confusable with it was hidden.
        late: Steps that were found too far off.
        listed: What was hidden and only listed as confusable with what was named.
        longest: Causes in the longest of these lists.
    """

    verdict: str
    named: tuple[str, ...]
    missed: tuple[Hidden, ...]
    wrong: tuple[tuple[str, str], ...]
    late: tuple[Hidden, ...]
    listed: tuple[Hidden, ...]
    longest: int


def draw_shift(seed: int, shortest: int = 5, longest: int = 60, less: int | None = None) -> DrawnShift:
    """A world with none to three effects, each from the first door on or from a later one.

    Args:
        seed: Of everything that is drawn.
        shortest, longest: Doors, drawn evenly in their logarithm.
        less: Number of an effect that the world is to be without, everything else as it is.
    """
    rng = np.random.default_rng([seed, 1616])
    count = int(np.exp(rng.uniform(np.log(shortest), np.log(longest + 1))))
    doors = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), count))
    world: dict = {"seed": seed}
    late: dict = {}
    step = int(rng.integers(3, count - 1))
    hidden: list[Hidden] = []
    whole, nothing = world, dict[str, dict]()
    for number, kind in enumerate(rng.choice(EFFECTS, size=int(rng.choice([0, 1, 1, 2, 3])), replace=False)):
        begins = step if rng.random() < 0.5 else 0
        world = nothing if number == less else whole
        into = {} if number == less else late if begins else world
        robot = into.setdefault("robot", {}) if kind in ("gap", "spring") else {}
        joint = int(rng.integers(0, 3))
        sign = float(rng.choice([-1.0, 1.0]))
        if kind == "gap":
            robot["gap"] = [float(rng.uniform(0.6e-4, 2e-4)) if k == joint else 0.0 for k in range(6)]
            hidden.append(Hidden("joint_backlash", f"joint {joint + 1}", begins))
        elif kind == "spring":
            joint = int(rng.choice([0, 2]))
            robot["stiffness_factor"] = [
                float(rng.uniform(0.5, 0.75)) if k == joint else 1.0 for k in range(6)
            ]
            hidden.append(Hidden("joint_stiffness", f"joint {joint + 1}", begins))
        elif kind == "force":
            into.setdefault("force", {})["factor"] = float(1.0 + sign * rng.uniform(0.15, 0.4))
            hidden.append(Hidden("process_force", "tool", begins))
        elif kind == "angle":
            into.setdefault("force", {})["angle"] = float(sign * rng.uniform(0.15, 0.4))
            hidden.append(Hidden("process_force_direction", "tool", begins))
        elif kind == "bending":
            into["tool"] = into.get("tool", {}) | {"stiffness": float(rng.uniform(1e6, 4e6))}
            hidden.append(Hidden("tool_bending", "tool", begins))
        elif kind == "weight":
            into["tool"] = into.get("tool", {}) | {
                "mass": float(rng.uniform(8.0, 25.0)),
                "com": [0.0, 0.0, float(rng.uniform(0.05, 0.2))],
            }
            hidden.append(Hidden("gravity_sag", "tool", begins))
        elif kind == "camera":
            world["camera"] = {"moved": [0.0, *(float(v) for v in _way(rng))], "from_door": step}
            hidden.append(Hidden("camera_shift", "camera", step))
        elif kind == "clamp":
            world["clamp"] = {"shift": [0.0, *(float(v) for v in _way(rng))], "from_door": step}
            hidden.append(Hidden("clamp_shift", "clamp", step))
        elif kind == "wear":
            world.setdefault("force", {})["wear_per_door"] = float(rng.uniform(0.2, 0.6)) / count
            hidden.append(Hidden("process_force", "tool"))
        elif kind == "warming":
            growth, rise = 1e-5, float(rng.uniform(10.0, 25.0))
            world["temperature"] = {"rise": rise, "hours": 0.5, "growth": growth}
            hidden.append(Hidden("thermal_growth", "cell"))
    if late:
        for section, values in late.items():
            late[section] = _with_earlier(section, whole, values)
        whole["change"] = [{"from_door": step, **late}]
    return DrawnShift(whole, tuple(hidden), doors)


def sizes(folder: Path, drawn: DrawnShift, seed: int) -> tuple[float, ...]:
    """By how much each hidden effect moves the points of the doors that have it, root mean square, in gauge noise.

    The same shift is gauged once more without it: whatever else is drawn is drawn again.

    Args:
        folder: That holds the shift as it was gauged; the others go beside it.
        drawn: The shift.
        seed: It was drawn and gauged with.
    """
    found, whole = [], inspections_in(folder)
    for number, one in enumerate(drawn.hidden):
        other = draw_shift(seed, less=number)
        without = inspections_in(
            gauged_shift(folder.parent / f"{folder.name}-{number}", other.world, drawn.doors, seed)
        )
        off = [a.deviation - b.deviation for a, b in zip(whole, without, strict=True) if len(a) == len(b)]
        found.append(float(np.sqrt(np.mean(np.concatenate(off[one.from_door :]) ** 2))) / NOISE)
    return tuple(found)


def _with_earlier(section: str, world: dict, values: dict) -> dict:
    return {**world.get(section, {}), **values}


def _way(rng: np.random.Generator) -> np.ndarray:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return rng.uniform(1e-4, 3e-4) * np.array([np.cos(angle), np.sin(angle)])


_CUTS: dict[Path, RecordedCut] = {}


def inspected(folder: Path) -> list[InspectedDoor]:
    """The doors of a gauged shift; a bag that milled several of them is read once."""
    found = []
    for inspection in inspections_in(folder):
        bag = inspection.bag.resolve()
        if bag not in _CUTS:
            _CUTS[bag] = recorded_cut(inspection)
        found.append(inspected_door(inspection, _CUTS[bag]))
    return found


def diagnosed(folder: Path, drawn: DrawnShift, seed: int) -> DoorDiagnosis:
    """The diagnosis of a shift that is milled and gauged in a folder."""
    return Inspections().diagnose(
        inspected(gauged_shift(folder, drawn.world, drawn.doors, seed)), lambda line: None
    )


def judged(diagnosis: DoorDiagnosis, hidden: tuple[Hidden, ...]) -> Judged:
    """Compare a diagnosis with what was hidden."""
    known = {(one.cause, one.where) for one in hidden}
    missed, wrong, late = [], [], []
    said = {finding.cause.key: finding for finding in diagnosis.findings}
    for finding in diagnosis.findings:
        keys = {finding.cause.key, *(cause.key for cause in finding.confusable)}
        if not keys & known:
            wrong.append(finding.cause.key)
    for one in hidden:
        tellers = [
            finding
            for finding in said.values()
            if (one.cause, one.where) in {finding.cause.key, *(cause.key for cause in finding.confusable)}
        ]
        if not tellers:
            missed.append(one)
        elif one.from_door and not any(_steps_near(diagnosis, finding.cause, one) for finding in tellers):
            late.append(one)
    return Judged(
        diagnosis.verdict,
        tuple(f"{f.cause!r}" for f in diagnosis.findings),
        tuple(missed),
        tuple(wrong),
        tuple(late),
        tuple(one for one in hidden if one not in missed and (one.cause, one.where) not in said),
        max((len(finding.confusable) for finding in diagnosis.findings), default=0),
    )


def _steps_near(diagnosis: DoorDiagnosis, cause, one: Hidden) -> bool:
    times = [door.time for door in diagnosis.problem.doors]
    if cause.course.kind not in ("begins", "changes", "drifts and changes"):
        return False
    return abs(times.index(cause.course.at) - one.from_door) <= NEAR
