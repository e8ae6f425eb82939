"""What to measure next: what tells confusable causes apart, and where doors have to stand for that."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.core.finding import Finding
from doormill_ros.diagnosis.parts.course import InTime
from doormill_ros.diagnosis.parts.problem import DoorDiagnosis

PLACES = 3  #: in which doors have to be milled to tell the joints apart
APART = 0.05  #: between places that count as two, on a joint's way over the door [m]
DECIDED = 9.2  #: squared distance of two models at which they are told apart 100 to 1
#: What shows a cause without another door.
_DIRECT = {
    "camera_shift": "picture a door whose edges were probed in the clamp",
    "clamp_shift": "picture a door in the clamp before and after milling",
    "process_force": "mill a test cut at half the feed: a force changes with it, a spring does not",
    "process_force_direction": "mill a test cut in the opposite direction: a force turns with it",
    "joint_stiffness": "load the joint with a known weight",
    "joint_backlash": "mill a wall twice, reached from both sides",
    "tool_bending": "mill the same pocket with a shorter mill",
    "tool_compliance": "press against the spindle and read a dial on the flange",
    "base_compliance": "press against the robot and read a dial at its foot",
    "tool_radius": "measure the mill, or mill a groove of its width",
    "tool_length": "measure the length of the mill",
    "gravity_sag": "mill a shallow pocket at the ends of the door's edge, where the arm reaches farthest and least",
    "thermal_growth": "mill one door cold and the same door after an hour of work",
}
_OTHERWISE = "mill the next doors with other recipes: features elsewhere on the door, cut in other directions"


def places_of(diagnosis: DoorDiagnosis) -> int:
    """In how many places of the cell features were milled."""
    points, door = diagnosis.problem.points, diagnosis.problem.door
    labels = np.char.add(np.char.add(door.astype(str), " "), points.feature)
    centres = np.array([points.point[labels == label].mean(axis=0) for label in np.unique(labels)])
    found: list[np.ndarray] = []
    for centre in centres:
        if all(np.linalg.norm(centre - other) > APART for other in found):
            found.append(centre)
    return len(found)


def next_sentence(diagnosis: DoorDiagnosis) -> str:
    """What to do next."""
    sentences = [_between(diagnosis, finding) for finding in diagnosis.findings if finding.confusable]
    if sentences:
        return "; ".join(dict.fromkeys(sentences))
    if places_of(diagnosis) < PLACES:
        return (
            "inspect doors whose features lie in at least three other places: forces, tool and place show on one "
            "door, joints and weight only over several"
        )
    if not diagnosis.findings and diagnosis.verdict == "consistent":
        return "nothing: the next door of each recipe is inspected as before"
    return _OTHERWISE


def _between(diagnosis: DoorDiagnosis, finding: Finding[InTime]) -> str:
    """The feature that tells a cause from the first of its doubles, or what else does."""
    problem, double = diagnosis.problem, finding.equals[0]
    # Where the effects alone were compared the double has no model of its own.
    other = double.model or diagnosis.best
    apart = (other.prediction.white - diagnosis.best.prediction.white)[:, 0] ** 2
    recipes = np.array([door.recipe for door in problem.doors])[problem.door]
    labels = np.char.add(np.char.add(problem.points.feature, " of "), recipes)
    each = {label: float(apart[labels == label].mean()) for label in np.unique(labels)}
    best = max(each, key=lambda label: each[label])
    pair = f"{finding.cause.name} from {double.cause.name}"
    needed = DECIDED / max(each[best], 1e-12)
    if needed < 2000.0:
        return f"to tell {pair}, measure about {needed:.0f} more points on {best}"
    direct = _DIRECT.get(finding.cause.name) or _DIRECT.get(double.cause.name) or _OTHERWISE
    return f"to tell {pair}, {direct}"
