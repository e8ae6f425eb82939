"""The RAPID side: writing the target file, loading the modules, milling on the virtual controller."""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.records.process import module_process
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram
from harness import Entry, entry

#: Table 4.7 of the thesis: from the signal to the generated targets, its RAPID file included [s].
THESIS_EXECUTION = 0.8
DOORS = ("thesis_1350_2deg", "standard_door")


def _program(name: str) -> MillingProgram:
    layout, robot, recipe = load_layout(), load_robot("irb6600_175_255"), load_recipe(name)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness)
    return generate_program(recipe, T_base_door, layout, robot, JointSpringModel(robot))


def _times(call, n: int) -> list[float]:
    call()
    times = []
    for _ in range(n):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return times


def _answer(controller: VirtualController) -> None:
    controller.io.write("doPathReady", controller.io.read("doPathRequest"))


def _mill(program: MillingProgram, arm: ControllerArm, home: Path, run: int) -> tuple[float, float]:
    """Wall time and simulated time of one door, from request to done."""
    (home / "Hei2.txt").write_bytes(render_target_file(program, f"run-{run}"))
    controller = VirtualController(
        home, arm, TruthRobot(arm.dh), process=module_process(program), expected_door="*", on_wait=_answer
    )
    start = time.perf_counter()
    controller.run()
    controller.executed_path()
    return time.perf_counter() - start, controller.now()


def run() -> list[Entry]:
    robot = load_robot("irb6600_175_255")
    arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
    programs = {name: _program(name) for name in DOORS}
    entries = []
    for name, n in zip(DOORS, (31, 7), strict=True):
        times = _times(lambda name=name: read_target_file(render_target_file(programs[name], "run")), n)
        entries.append(
            entry(
                f"target file written and read back, {name}",
                statistics.median(times),
                "s",
                "thesis, table 4.7: whole execution",
                THESIS_EXECUTION,
                n,
            )
        )
    texts = [(resource(name).read_text(), name) for name in OWN_MODULES]
    times = _times(lambda: [parse_module.__wrapped__(text, name) for text, name in texts], 7)
    lines = sum(text.count("\n") for text, _ in texts)
    print(f"our modules: {lines} lines parsed in {statistics.median(times):.3f} s")
    with tempfile.TemporaryDirectory() as folder:
        for name, n in zip(DOORS, (5, 3), strict=True):
            runs = [_mill(programs[name], arm, Path(folder), i) for i in range(n)]
            wall, simulated = (statistics.median(values) for values in zip(*runs, strict=True))
            entries.append(
                entry(
                    f"virtual controller mills {name}", wall, "s", "the same door in real time", simulated, n
                )
            )
    return entries
