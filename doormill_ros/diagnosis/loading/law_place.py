"""Where a cause of a loading test would act that is a part of a law without a name."""

from __future__ import annotations

from doormill_ros.diagnosis.law.place import LawPlace
from doormill_ros.diagnosis.law.place import place_of as of_term
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.law.term import LawTerm

#: Place and driver of what a cause would leave; empty where its own place has the word.
_CAUSES = {
    "joint_stiffness": ("", "own torque"),
    "joint_backlash": ("", "direction"),
    "joint_hardening": ("", "own torque"),
    "joint_friction": ("", "direction"),
    "joint_cross_compliance": ("", "wrench"),
    "link_bending": ("", "wrench"),
    "base_compliance": ("base", "wrench"),
    "tool_compliance": ("tool", "wrench"),
    "wrench_frame_rotation": ("sensor", "wrench"),
    "wrench_gain": ("sensor", "wrench"),
    "tracker_frame_rotation": ("tracker", "constant"),
    "tracker_scale": ("tracker", "constant"),
    "thermal_drift": ("tracker", "time under load"),
    "reflector_position": ("reflector", "constant"),
    "joint_offset": ("", "constant"),
}


def place_of(term: ElasticCause) -> LawPlace:
    """Of a term, or of a cause that is not believed."""
    if isinstance(term, LawTerm):
        return of_term(term)
    where, driver = _CAUSES.get(term.name, ("", "constant"))
    spoken = f"reflector {term.where}" if where == "reflector" else where or term.where
    return LawPlace(spoken, driver, term.name.replace("_", " "))
