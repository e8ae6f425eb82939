"""A folder with the force log of a milling test: one YAML that says what was milled when, and the files.

schema: doormill/milling-log/1
robot: irb6600_175_255
wrench_frame_rotation: 0.76878       # rad, sensor axes to flange axes about the flange z
file: cut.csv                        # readings while it mills
q: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]    # rad, a posture with the orientation in which it mills
segments: {left_line: [12.0, 14.5], top_turn: [14.5, 15.1]}   # s since the start of the log
rest:                                # readings of the spindle held still, three orientations or more
  - {file: rest_1.csv, q: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]}
air: [2.0, 8.0]                      # instead of rest: a time in which the mill turned in the air

The spindle's weight is identified from `rest`, or taken off with the mean of `air`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros.arrays import FloatArray
from doormill_ros.files import write_atomically
from doormill_ros.frames import rotation_z
from doormill_ros.identification.payload import Payload, identify_payload
from doormill_ros.identification.process_forces import SegmentForce, lever_arm, segment_forces
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.raw.raw_files import read_force_log
from doormill_ros.measurements.raw.steady import steady_window
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotError
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.units import m_to_mm

SCHEMA = "doormill/milling-log/1"
FILE_NAME = "milling_log.yaml"
RECIPE_NAME = "wrench.yaml"


@dataclass(frozen=True, eq=False)
class ProcessForces:
    """What a milling test tells.

    Attributes:
        forces: Mean wrench of every segment, flange axes at the sensor.
        payload: The spindle, None where an air cut stood for it.
        arm: Distance along z from the sensor to where pure forces explain the moments [m].
    """

    forces: list[SegmentForce]
    payload: Payload | None
    arm: float

    @property
    def lines(self) -> list[str]:
        """Text to print."""
        lines = []
        if self.payload is not None:
            centre = ", ".join(f"{c:.0f}" for c in m_to_mm(self.payload.centre))
            lines.append(f"spindle {self.payload.mass:.2f} kg, centre of gravity ({centre}) mm, sensor axes")
        lines.append(
            f"{'segment':20} samples {'Fx, Fy, Fz [N]':>24} {'Mx, My, Mz [N m]':>24}  +- of the mean"
        )
        for force in self.forces:
            f, m = (" ".join(f"{v:7.1f}" for v in part) for part in np.split(force.wrench, 2))
            df, dm = (float(part.max()) for part in np.split(force.standard_error, 2))
            lines.append(f"{force.name:20} {force.samples:7d} {f:>24} {m:>24}  {df:.1f} N, {dm:.1f} N m")
        return lines

    def recipe_fields(self) -> dict[str, Any]:
        """The two fields of a recipe's feature that hold the process wrench."""
        rows = {f.name: [round(float(v), 1) for v in f.wrench] for f in self.forces}
        return {"wrench_point_mm": round(m_to_mm(self.arm)), "wrench_n_nm": rows}

    def write(self, out: Path) -> list[Path]:
        """Write wrench.yaml, whose lines a recipe's feature takes; returns the files."""
        out.mkdir(parents=True, exist_ok=True)
        head = "# Written by `identify --milling`: process wrench of a feature, for its recipe.\n"
        text = yaml.safe_dump(self.recipe_fields(), sort_keys=False, default_flow_style=None)
        write_atomically(out / RECIPE_NAME, head + text)
        return [out / RECIPE_NAME]


def process_forces_of(folder: Path) -> ProcessForces:
    """Mean process wrenches of a milling test.

    Args:
        folder: Holds milling_log.yaml and the files that it names.

    Raises:
        DataSetError: The description or a file cannot be used, or a rest is not steady.
        MillingError: A segment has too few samples, or the rests do not tell the spindle's weight.
    """
    document = SetDocument(folder / FILE_NAME)
    document.check_schema(SCHEMA)
    try:
        kinematics = Kinematics(load_robot(str(document.get("robot"))))
    except RobotError as error:
        raise document.fail(("robot",), f"cannot be used: {error.message}") from error
    rotation = document.number("wrench_frame_rotation")
    log = read_force_log(folder / str(document.get("file")))
    names = document.get("segments")
    if not isinstance(names, dict) or not names:
        raise document.fail(("segments",), f"is {names!r}, allowed are names with start and end")
    spans = {str(name): _span(document, "segments", str(name)) for name in names}
    if ("rest" in document.data) == ("air" in document.data):
        raise document.fail(("rest",), "or air must be given, and not both")
    if "air" in document.data:
        forces = segment_forces(log, spans, rotation, air=_span(document, "air"))
        return ProcessForces(forces, None, _arm(forces))
    payload = _payload(document, folder, kinematics, rotation)
    R_base_flange = kinematics.forward(document.vector(JOINTS, "q"))[:3, :3]
    forces = segment_forces(log, spans, rotation, payload, R_base_flange)
    return ProcessForces(forces, payload, _arm(forces))


def _payload(document: SetDocument, folder: Path, kinematics: Kinematics, rotation: float) -> Payload:
    """The spindle from the rests."""
    readings, orientations = [], []
    rests = document.get("rest")
    if not isinstance(rests, list):
        raise document.fail(("rest",), f"is {rests!r}, allowed is a list of files with q")
    for number, rest in enumerate(rests, start=1):
        if not isinstance(rest, dict) or not rest.keys() >= {"file", "q"}:
            raise document.fail(("rest",), f"number {number} is {rest!r}, it needs file and q")
        q = _numbers(rest["q"], JOINTS)
        if q is None:
            raise document.fail(
                ("rest",), f"number {number} has q {rest['q']!r}, allowed are {JOINTS} finite numbers"
            )
        readings.append(steady_window(read_force_log(folder / str(rest["file"]))).mean)
        orientations.append(kinematics.forward(q)[:3, :3] @ rotation_z(rotation))
    return identify_payload(np.reshape(readings, (-1, 6)), np.reshape(orientations, (-1, 3, 3)))


def _numbers(value: Any, count: int) -> FloatArray | None:
    """Finite numbers, shape (count,); None for anything else."""
    try:
        numbers = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return None
    return numbers if numbers.shape == (count,) and np.all(np.isfinite(numbers)) else None


def _span(document: SetDocument, *keys: str) -> tuple[float, float]:
    start, end = document.vector(2, *keys)
    return float(start), float(end)


def _arm(forces: list[SegmentForce]) -> float:
    return lever_arm(np.array([force.wrench for force in forces]))
