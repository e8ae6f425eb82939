"""Where something without a name acts and what drives it, in the words of diagnosis.json."""

from __future__ import annotations

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


def place_of(term: ElasticCause) -> tuple[str, str]:
    """Place and driver."""
    if isinstance(term, LawTerm):
        return term.where, term.driver
    where, driver = _CAUSES.get(term.name, ("", "constant"))
    return (f"reflector {term.where}" if where == "reflector" else where or term.where), driver


def acts_on(term: ElasticCause) -> str:
    """What is off there."""
    return term.acts_on if isinstance(term, LawTerm) else term.name.replace("_", " ")
