"""Things that several tests of the ABB side need: RAPID on a bare machine, the thesis' listings, doors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.cell.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram
from support.thesis_listings import load_listings


class BareMachine:
    """A machine without robot: keeps what the program does to it."""

    def __init__(self, home: Path) -> None:
        self.home = home
        self.signals: dict[str, float] = {"doA": 0.0, "diB": 0.0, "aoC": 0.0}
        self.lines: list[str] = []
        self.entries: list[tuple[str, str, str]] = []
        self.moves: list = []
        self.time = 0.0
        self.statements = 0

    def signal_kinds(self):
        return {"doA": "signaldo", "diB": "signaldi", "aoC": "signalao"}

    def read_signal(self, name):
        return self.signals[name]

    def write_signal(self, name, value):
        self.signals[name] = value

    def now(self):
        return self.time

    def statement(self, _file, _line):
        self.statements += 1

    def wait(self, condition, seconds):
        if condition is not None and condition():
            return True
        self.time += seconds or 0.0
        return condition is None

    def move(self, move):
        self.moves.append(move)

    def wait_in_position(self):
        pass

    def pendant(self, text):
        self.lines.append(text)

    def log(self, kind, title, text):
        self.entries.append((kind, title, text))


@pytest.fixture
def machine(tmp_path: Path) -> BareMachine:
    return BareMachine(tmp_path)


@pytest.fixture
def load(machine: BareMachine) -> Callable[..., RapidProgram]:
    """Load module text; `body` alone becomes PROC main."""

    def load_(declarations: str = "", body: str = "", rest: str = "") -> RapidProgram:
        text = f"MODULE bench\n{declarations}\nPROC main()\n{body}\nENDPROC\n{rest}\nENDMODULE\n"
        return RapidProgram([parse_module(text, "test.mod")], machine)

    return load_


@pytest.fixture
def say(load, machine) -> Callable[..., list[str]]:
    """Run statements and give what they wrote on the pendant."""

    def say_(body: str, declarations: str = "", rest: str = "") -> list[str]:
        load(declarations, body, rest).run()
        return machine.lines

    return say_


@pytest.fixture(scope="session")
def arm() -> ControllerArm:
    robot = load_robot("irb6600_175_255")
    return ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)


@pytest.fixture(scope="session")
def door() -> Callable[..., MillingProgram]:
    """The generated milling program of a recipe on a displaced door."""
    made: dict[tuple, MillingProgram] = {}
    layout, robot = load_layout(), load_robot("irb6600_175_255")

    def door_(name: str, y: float = 0.0, z: float = 0.0, rotation: float = 0.0) -> MillingProgram:
        key = (name, y, z, rotation)
        if key not in made:
            recipe = load_recipe(name)
            T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(y, z, rotation))
            made[key] = generate_program(recipe, T_base_door, layout, robot, JointSpringModel(robot))
        return made[key]

    return door_


def answer(controller: VirtualController) -> None:
    """A PC that has its file ready at once, and lowers ready when the request falls."""
    controller.io.write("doPathReady", controller.io.read("doPathRequest"))


class WatchedController(VirtualController):
    """A controller that keeps the motion instructions it was given."""

    def __init__(self, *args, **kwargs) -> None:
        self.moves: list = []
        super().__init__(*args, **{"on_wait": answer, "patience": 5.0, **kwargs})

    def move(self, move):
        self.moves.append(move)
        super().move(move)

    @property
    def executed_count(self) -> int:
        """Samples of motion so far."""
        return len(self._engine.recording.time)

    @property
    def executed_motion(self) -> int:
        """Index of the motion that is being executed."""
        return self._engine.recording.context[-1].index


@pytest.fixture
def controller(tmp_path: Path, arm: ControllerArm) -> Callable[..., WatchedController]:
    """A controller with the project's modules, HOME: in tmp_path, a rigid robot, and a willing PC."""

    def controller_(**kwargs) -> WatchedController:
        return WatchedController(kwargs.pop("home", tmp_path), arm, **{"expected_door": "*", **kwargs})

    return controller_


@pytest.fixture(scope="session")
def thesis_listings() -> dict[str, str]:
    """The thesis' listings by figure number, repaired."""
    return load_listings()[0]


THESIS_TARGETS = ["init", "10", "11", "12", "13", "14", "15", "init2", "20", "21", "22", "23", "24", "25"]


@pytest.fixture(scope="session")
def thesis_module(thesis_listings) -> Callable[..., str]:
    """The listings as one module; what they leave out is declared around them."""

    def thesis_module_(home: str = "", home2: str = "", path: bool = True) -> str:
        nowhere = "[[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]"
        strings = "\n".join(f"VAR string data{n};" for n in ("", *range(2, 15)))
        targets = "\n".join(f"VAR robtarget Target_{n};" for n in THESIS_TARGETS)
        listing = thesis_listings
        return f"""MODULE Thesis
VAR iodev File;
{strings}
{targets}
CONST robtarget Target_Home := {home or nowhere};
CONST robtarget Target_Home2 := {home2 or nowhere};
PERS tooldata Mill_UiA := [TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];
{listing["3.36"]}
FUNC robtarget StringToTarget(string value)
{listing["3.37"]}
{listing["3.38"]}
{listing["3.39"]}
ENDFUNC
{listing["3.40"]}
{listing["3.41"] if path else "PROC Path_20() ENDPROC"}
ENDMODULE
"""

    return thesis_module_


def rounding(values: np.ndarray, half_of_last_decimal: np.ndarray) -> np.ndarray:
    """How far a number may be from the one it was written from: half a decimal, and float32."""
    return half_of_last_decimal + np.spacing(np.abs(values).astype(np.float32)).astype(float) / 2.0 + 1e-12
