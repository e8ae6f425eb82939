"""Things that several tests of the ABB side need: RAPID on a bare machine, the thesis' listings, doors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.cabinet.teach_pendant import TeachPendant
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES, read_installed
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from doormill_ros.simulation.controller.rapid.faults import RapidStop
from doormill_ros.simulation.controller.rapid.machine import Dialog
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram
from support.thesis_listings import load_listings


class BareMachine:
    """A machine without robot: keeps what the program does to it.

    `plan` holds (time, signal, value) of what the plant will do, in the order of time.
    """

    STEP = 0.001

    def __init__(self, home: Path) -> None:
        self.home = home
        self.signals: dict[str, float] = {"doA": 0.0, "diB": 0.0, "aoC": 0.0, "goD": 0.0, "giE": 0.0}
        self.lines: list[str] = []
        self.entries: list[tuple[str, str, str]] = []
        self.numbers: list[int] = []
        self.moves: list = []
        self.time = 0.0
        self.statements = 0
        self.pendant_unit = TeachPendant()
        self.plan: list[tuple[float, str, float]] = []

    def set_attendant(self, attendant):
        self.attendant = attendant

    def signal_kinds(self):
        return {"doA": "signaldo", "diB": "signaldi", "aoC": "signalao", "goD": "signalgo", "giE": "signalgi"}

    def read_signal(self, name):
        return self.signals[name]

    def write_signal(self, name, value):
        self.signals[name] = value

    def now(self):
        return self.time

    def statement(self, _file, _line):
        self.statements += 1
        self._pass(20e-6)

    def wait(self, condition, seconds):
        """Time passes while something may still happen, and otherwise jumps to the end."""
        end = None if seconds is None else self.time + seconds
        while condition is None or not condition():
            if end is not None and self.time >= end - 1e-9:
                return False
            if condition is None and not self.plan and not self.attendant.armed:
                self.time = end
                continue
            assert self.time < 1000.0, "the program would wait for ever"
            self._pass(self.STEP if end is None else min(self.STEP, end - self.time))
        return True

    def _pass(self, seconds):
        self.time += seconds
        while self.plan and self.plan[0][0] <= self.time:
            _, name, value = self.plan.pop(0)
            self.signals[name] = value
        self.attendant.attend()

    def move(self, move):
        self.moves.append(move)

    def stop_program(self, instruction):
        """Nobody is there to start it again."""
        raise RapidStop(f"stopped by {instruction}", by_program=True)

    def wait_in_position(self):
        pass

    def wait_at_rest(self):
        pass

    def forget_paths(self):
        self.moves.clear()

    def pendant(self, text):
        self.lines.append(text)

    def show_dialog(self, dialog):
        self.pendant_unit.show(dialog)

    def dialog_answer(self):
        return self.pendant_unit.answer

    def operating_mode(self):
        return "AUTO"

    def log(self, kind, title, text, number=0):
        self.entries.append((kind, title, text))
        self.numbers.append(number)


@pytest.fixture
def read_configuration(tmp_path: Path) -> Callable[..., object]:
    """What a reader of system parameters makes of a text."""

    def read(reader: Callable[[Path], object], text: str) -> object:
        path = tmp_path / "parameters.cfg"
        path.write_text(text)
        return reader(path)

    return read


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
    """A PC that announces the file in HOME at once, and somebody who exchanges a door that was begun."""
    if not controller.program.has_data("requestNumber"):  # not the project's own modules
        controller.io.write(signals.READY, controller.io.read(signals.REQUEST))
        return
    request = int(controller.program.read("requestNumber")) if controller.io.read(signals.REQUEST) else 0
    if request and controller.io.read(signals.READY_NUMBER) != request:
        (controller.home / signals.ORDER_FILE).write_text(f"{run_of(controller.home)}\n{request}\n")
    controller.io.write(signals.READY_NUMBER, request)
    controller.io.write(signals.READY, int(bool(request)))
    spent, in_hand = (controller.program.read(name) for name in ("doorSpent", "doorInHand"))
    if not in_hand:
        controller.cell.set_input("diDoorClamped", float(not spent))


def run_of(home: Path) -> str:
    """The run that the file in HOME is of."""
    path = home / signals.TARGET_FILE
    lines = path.read_bytes().decode("latin-1").splitlines() if path.exists() else []
    return next((line.removeprefix("#run ") for line in lines if line.startswith("#run ")), "none")


READING = """MODULE Reading
VAR bool accepted:=FALSE;
PROC ReadAndTell()
! No start comes before it, with which people would name the door.
expectedDoor:=ANY_DOOR;
accepted:=ReadTargetFile();
ENDPROC
ENDMODULE
"""


def reading_modules(folder: Path) -> list[Path]:
    """The project's modules and a procedure that reads the file and keeps the answer in `accepted`."""
    path = folder / "Reading.mod"
    path.write_text(READING)
    return [*(resource(name) for name in OWN_MODULES), path]


class WatchedController(VirtualController):
    """A controller that keeps the motion instructions it was given."""

    def __init__(self, *args, **kwargs) -> None:
        self.moves: list = []
        self.expected = kwargs["expected_door"]
        self.clamped = 1.0
        super().__init__(*args, **{"on_wait": answer, "patience": 5.0, **kwargs})

    def move(self, move):
        self.moves.append(move)
        super().move(move)

    def run(self, *args, **kwargs):
        """Another door is clamped and named."""
        if "diDoorClamped" in self.signal_kinds():
            self.cell.set_input("diDoorClamped", self.clamped)
        if self.program.has_data("expectedDoor"):
            self.name_door(self.expected)
        super().run(*args, **kwargs)

    def run_to_question(self) -> Dialog:
        """Run the program until it asks something; it is stopped there, and nothing is answered."""

        def stop(dialog: Dialog) -> str:
            self.stop()
            return dialog.buttons[0][0]

        self.teach_pendant.operator = stop
        with pytest.raises(RapidStoppedError):
            self.run()
        return self.teach_pendant.dialogs[-1]

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
        files = {
            n: kwargs.pop(n) for n in ("modules", "io_configuration", "system_parameters") if n in kwargs
        }
        options = {"expected_door": "*", "installed": read_installed(**files), **kwargs}
        return WatchedController(options.pop("home", tmp_path), arm, **options)

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
