"""Run the motions of a target file on the simulated controller, without the RAPID program around them.

The reader is a tests' own: it knows the file by its lines alone.
"""

import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.moves import MotionContext
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.records.process import Process, no_wrench

HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]  # jposHome of rapid/DoorCell.mod, for files that do not say it
KINDS = {"L": "MoveL", "C": "MoveC", "A": "MoveAbsJ"}
RACK = "PTM"  # a tool into its place, out of it, and to the gauge
NOT_CONNECTED = [9e9] * 6


@dataclass(frozen=True)
class FileMotion:
    """A motion of the file, its numbers counted from 1 as written."""

    kind: str
    target: int
    via: int
    speed: float  # mm/s
    zone: str
    feature: str
    cutting: bool


@dataclass(frozen=True)
class FileProgram:
    """What a target file says of motions."""

    home: list[float]  # degrees
    targets: list[list[list[float]]]  # robtargets
    points: list[list[float]]  # degrees
    motions: list[FileMotion]


def read_file(text):
    """Targets, points and motions of a target file."""
    lines = text.splitlines()
    said = [line.split(" ", 1) for line in lines if line.startswith("#")]
    features = [rest for word, rest in said if word == "#feature"]
    motions = []
    for word, rest in said:
        if word == "#move":
            kind, target, via, speed, zone, number, cutting, _ = json.loads(
                re.sub("TRUE|FALSE", lambda m: m[0].lower(), rest)
            )
            feature = features[number - 1] if number else ""
            motions.append(FileMotion(kind, target, via, speed, zone, feature, cutting))
    home = next((json.loads(rest) for word, rest in said if word == "#home"), HOME)
    points = [json.loads(rest) for word, rest in said if word == "#point"]
    targets = []
    for line in lines:
        if not line.startswith("#"):
            n = [float(v) for v in line.split(";") if v]
            targets.append([n[:3], n[3:7], n[7:11], NOT_CONNECTED])
    return FileProgram(home, targets, points, motions)


def run_file(text, robot="irb6600_175_255"):
    """What a rigid robot does that runs a file from home and back.

    Returns:
        The executed path, and whether the spindle turned at each sample: on the way home it stands.
    """
    program, description = read_file(text), load_robot(robot)
    arm = ControllerArm(description.dh, description.lower, description.upper, description.max_velocity)

    moved = [number for number, motion in enumerate(program.motions) if motion.kind not in RACK]

    def context_of(_program, count):
        if count >= len(moved):
            return MotionContext()
        motion = program.motions[moved[count]]
        return MotionContext(moved[count], motion.feature, motion.cutting)

    with tempfile.TemporaryDirectory() as folder:
        controller = VirtualController(
            Path(folder), arm, process=Process(context_of, no_wrench), start=np.radians(program.home)
        )
        controller.supervise_configuration(linear=True, on=False)  # as rapid/DoorMill.mod does
        read = controller.program.read
        way_home = FileMotion("A", 0, 0, 500.0, "fine", "", False)
        for number, motion in enumerate([*program.motions, way_home]):
            if motion.kind in RACK:
                controller.wait_in_position()
                controller.cell.rack.hold(None if motion.kind == "P" else motion.via - 1)
                continue
            joints = (
                program.points[motion.target - 1] if motion.target and motion.kind == "A" else program.home
            )
            controller.move(
                Move(
                    kind=KINDS[motion.kind],
                    target=[joints, NOT_CONNECTED]
                    if motion.kind == "A"
                    else program.targets[motion.target - 1],
                    via=program.targets[motion.via - 1] if motion.via else None,
                    speed=[motion.speed, 500.0, 5000.0, 1000.0],
                    zone=read(motion.zone),
                    tool=read("toolMill"),
                    wobj=read("wobjDoor"),
                    duration=None,
                    file="target file",
                    line=number,
                )
            )
        controller.wait_in_position()
        executed = controller.executed_path()
    return executed, executed.motion >= 0
