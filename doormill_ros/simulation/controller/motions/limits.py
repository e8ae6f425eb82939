"""What the simulated controller refuses of motions, and how fast it can be.

Each value is the strict one: no RobotWare is known that is stricter. A cell may be given others in a file of the
form of config/controller.yaml.
"""

from __future__ import annotations

from pathlib import Path

from pydantic.dataclasses import dataclass

from doormill_ros.config import read
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import ControllerLimitsError
from doormill_ros.units import deg_to_rad
from doormill_ros.values import Count, NotNegative, Positive, Section

FORM = "config/controller.yaml"


@dataclass(frozen=True)
class ControllerLimits(Section):
    r"""Rules for motions; [?] marks what was seen in no public source, docs/rapid.md names its manual.

    Attributes:
        segment_time: Shortest time of a motion [s]; a shorter one is slowed down to it. Paths are planned in steps
            of 4 to 24 ms, depending on robot and PathResol [?]; the largest.
        short_in_row: So many motions below `segment_time` in a row are executed, the next one stops the program with
            event 50078, too many closely spaced positions (ros-industrial/abb#185: "make your trajectory sparser").
        zero_length: A motion of no length with a zone is a corner path failure too, event 50024 (of "closely programmed
            points" the closest [?]).
        planning_time: Before a zone is reached the next motion must have been known for so long [s], else the
            corner is a stop point with event 50024 (ABB tech pages on corner path failure; the time is [?]).
        quadrant_margin: A MoveJ under ConfJ\On, and a Cartesian motion under ConfL\On, may end with axis 1, 4 or 6 no
            nearer to a border of quadrants [rad]: a calibrated arm may stand on the other side, which the controller
            refuses. How far a calibration moves the zero of an axis is [?].
        wrist_singularity: Axis 5 of a Cartesian motion is at least so far from straight [rad]; event 50026, "critical
            zone 0 deg +-3 deg" (industrialmonitordirect.com, IRC5 event 50026).
        acceleration: Of the tool along and across its path [m/s^2] [?].
        ramp: Time in which an axis reaches its largest speed [s] [?].
        servo: Time over which the servo rounds what is left of a corner [s]: some steps of 4 ms [?].
        manual_speed: Largest speed of the tool in manual mode at reduced speed [m/s] (ISO 10218-1: 250 mm/s).
        quick_factor: A quick stop brakes harder than a program stop by this factor [?].
        brake_delay: From the loss of power until the brakes hold; the arm goes on meanwhile [s] [?].
        brake_ramp: Time in which brakes stop an axis from its largest speed [s]; no two axes alike [?].
        regain_distance: A start from a place further from the path is refused [m]; Path Return Region [?].
        regain_turn: The same for the tool's orientation [rad] [?].
        regain_speed: Speed of the way back to the path [m/s] [?].
        event_routine_time: An event routine of STOP, QSTOP, RESTART, POWERON or RESET is broken off after this [s] [?].
    """

    segment_time: NotNegative = 0.024
    short_in_row: Count | None = 3
    zero_length: bool = True
    planning_time: NotNegative = 0.024
    quadrant_margin: NotNegative = float(deg_to_rad(0.5))
    wrist_singularity: Positive = float(deg_to_rad(3.0))
    acceleration: Positive = 2.0
    ramp: Positive = 0.4
    servo: Positive = 0.012
    manual_speed: Positive = 0.25
    quick_factor: Positive = 3.0
    brake_delay: NotNegative = 0.05
    brake_ramp: Positive = 0.3
    regain_distance: Positive = 0.05
    regain_turn: Positive = 0.2
    regain_speed: Positive = 0.05
    event_routine_time: Positive = 10.0


def load_limits(path: Path | None = None) -> ControllerLimits:
    """Limits from a file; None for the shipped config/controller.yaml.

    Raises:
        ControllerLimitsError: No such file, or a key or value that is not allowed.
    """
    return read(path or resource(FORM), ControllerLimits, ControllerLimitsError)
