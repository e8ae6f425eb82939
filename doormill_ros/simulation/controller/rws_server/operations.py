"""What a client may ask of the cabinet, free of paths and spellings of either version."""

from __future__ import annotations

import time
from collections.abc import Callable

from doormill_ros.simulation.controller.operation.states import OperatingMode, StopMode
from doormill_ros.simulation.controller.rapid.errors import OrderRefusedError, RapidProgramError, SignalError
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet, SimulatedSignal
from doormill_ros.simulation.controller.rws_server.files import Files
from doormill_ros.simulation.controller.rws_server.queues import Queues
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    CODE_NO_MODULE,
    CODE_NO_RESOURCE,
    CODE_NO_SYMBOL,
    CODE_REJECTED,
    CODE_UNKNOWN_SIGNAL,
    CODE_WRONG_STATE,
    Item,
    RefusalError,
)
from doormill_ros.simulation.controller.rws_server.rights import Rights
from doormill_ros.simulation.controller.rws_server.served import LogItem, as_mapping, level_text

Form = dict[str, str]

TASK = "T_ROB1"
_MESSAGE_TYPES = {"information": "1", "warning": "2", "error": "3"}
_OUTPUTS = ("DO", "AO", "GO")
#: Version that is usual with a version of the web services.
_ROBOTWARE = {1: 6, 2: 7}


class Operations:
    """Reads and changes of one cabinet; raises `RefusalError` as the controller would answer."""

    def __init__(
        self, cabinet: Cabinet, version: int, alive: Callable[[str], bool], robotware: int = 0
    ) -> None:
        """Keep the parts; see `Rights` for `alive` and `robotware`."""
        self.cabinet = cabinet
        self.version = version
        self.files = Files(cabinet, version)
        self.rights = Rights(cabinet, version, alive, robotware)
        self._robotware = robotware or _ROBOTWARE[version]
        self.queues = Queues()

    # Signals -------------------------------------------------------------------------------------

    def signal(self, path: str) -> SimulatedSignal:
        """The signal at a path of the tree."""
        signal = self.cabinet.find_signal(path)
        if signal is None:
            raise RefusalError(404, CODE_UNKNOWN_SIGNAL, f"Invalid IO signal name {path}")
        return signal

    def signal_item(self, signal: SimulatedSignal, kind: str = "ios-signal-li", suffix: str = "") -> Item:
        """A signal with its value."""
        values = {"lvalue": level_text(self.cabinet.value(signal.name)), "lstate": "not simulated"}
        if kind == "ios-signal-li":
            values = {"name": signal.name, "type": signal.kind, "category": "", **values}
        return Item(kind, signal.path, f"/rw/iosystem/signals/{signal.path}{suffix}", values)

    def list_signals(self) -> list[Item]:
        """All signals."""
        return [self.signal_item(s) for s in self.cabinet.signals.values()]

    def write_signal(self, path: str, form: Form, owner: str) -> None:
        """Set a signal, if operating mode and access level allow."""
        signal = self.signal(path)
        mode, value = form.get("mode", "value"), _number(form.get("lvalue", ""))
        turned = mode in ("invert", "toggle") and signal.largest == 1.0
        if not turned and (mode != "value" or value is None or not 0.0 <= value <= signal.largest):
            raise RefusalError(400, CODE_INVALID, f"invalid mode {mode!r} or lvalue {form.get('lvalue')!r}")
        self.rights.require_write(owner)
        automatic = self.cabinet.controller.panel.state.mode is OperatingMode.AUTO
        writer = "remote_auto" if automatic else "remote_manual"
        if writer not in signal.access.writers or signal.kind not in _OUTPUTS:
            raise RefusalError(403, CODE_REJECTED, "Rejected")
        level = 1 - self.cabinet.value(signal.name) if turned else value
        try:
            self.cabinet.set_value(signal.name, level or 0.0)
        except SignalError as error:
            raise RefusalError(400, CODE_INVALID, error.message) from error

    def system(self) -> Item:
        """Version of RobotWare."""
        return Item("sys-system", "system", "", {"name": "simulated", "rwversion": f"{self._robotware}.0.0"})

    # Panel and execution -------------------------------------------------------------------------

    def panel(self, what: str, event: bool = False) -> Item:
        """Drives, operating mode or speed override."""
        state = self.cabinet.controller.panel.state
        value = {
            "ctrlstate": state.controller.value,
            "opmode": state.mode.value,
            "speedratio": level_text(state.speed_override),
        }[what]
        return Item(f"pnl-{what}{'-ev' if event else ''}", what, f"/rw/panel/{what}", {what: value})

    def set_speed_ratio(self, form: Form, owner: str) -> None:
        """Change the override; in automatic mode alone."""
        value = _number(form.get("speed-ratio", ""))
        if value is None or not 0.0 <= value <= 100.0:
            raise RefusalError(400, CODE_INVALID, "Invalid input form data")
        self.rights.require_mastership(owner, implicit=False)
        if self.cabinet.controller.panel.state.mode is not OperatingMode.AUTO:
            raise RefusalError(403, CODE_REJECTED, "Rejected")
        self._order(lambda: self.cabinet.controller.panel.set_speed_override(value))

    def set_motors(self, form: Form, owner: str) -> None:
        """Motors on or off."""
        wanted = form.get("ctrl-state")
        if wanted not in ("motoron", "motoroff"):
            raise RefusalError(400, CODE_INVALID, "ctrl-state missing")
        self.rights.require_write(owner)
        self._order(lambda: self.cabinet.controller.panel.motors(wanted == "motoron"))

    def execution(self, event: bool = False) -> Item:
        """State of the RAPID execution."""
        state = self.cabinet.controller.panel.state.execution.value
        if event:
            return Item(
                "rap-ctrlexecstate-ev",
                "execution",
                "/rw/rapid/execution;ctrlexecstate",
                {"ctrlexecstate": state},
            )
        return Item("rap-execution", "execution", "", {"ctrlexecstate": state, "cycle": "forever"})

    def start(self, owner: str, implicit: bool) -> None:
        """Start the program; 1.0 answers 400 in the wrong state."""
        self.rights.require_write(owner)
        if self.rights.holder() not in (None, owner):
            self.rights.require_mastership(owner, implicit)
        self._order(self.cabinet.controller.start, 400 if self.version == 1 else 403)

    def stop(self, form: Form, owner: str) -> None:
        """Stop the program."""
        if form.get("stopmode", "stop") not in {mode.value for mode in StopMode}:
            raise RefusalError(400, CODE_INVALID, "Invalid input form data")
        self.rights.require_write(owner)
        self._order(lambda: self.cabinet.controller.stop(StopMode(form.get("stopmode", "stop"))))

    def reset_pointer(self, owner: str, implicit: bool) -> None:
        """Program pointer to main."""
        self.rights.require_mastership(owner, implicit)
        self._order(self.cabinet.controller.reset_pointer)

    def tasks(self) -> list[Item]:
        """The one motion task."""
        running = self.execution().values["ctrlexecstate"] == "running"
        values = {"name": TASK, "type": "normal", "taskstate": "linked"}
        values |= {"excstate": "started" if running else "stopped", "active": "On", "motiontask": "TRUE"}
        return [Item("rap-task-li", TASK, "", values)]

    def activate(self, task: str, active: bool, owner: str) -> None:
        """Activate the task, which it is; without it there would be no robot program."""
        self.rights.require_write(owner)
        if task != TASK:
            raise RefusalError(404, CODE_NO_RESOURCE, f"no task {task}")
        if not active:
            raise RefusalError(403, CODE_WRONG_STATE, f"{TASK} is the only motion task")

    def modules(self) -> list[Item]:
        """Modules of the task."""
        names = self.cabinet.controller.modules()
        return [Item("rap-module-info-li", name, "", {"name": name, "type": "ProgMod"}) for name in names]

    def module(self, name: str) -> Item:
        """One module."""
        found = next((item for item in self.modules() if item.title.lower() == name.lower()), None)
        if found is not None:
            return found
        if self.version == 1:
            raise RefusalError(404, CODE_NO_RESOURCE, "Resource not found")
        raise RefusalError(400, CODE_NO_MODULE, "module name/parameter is invalid or missing")

    # RAPID data ------------------------------------------------------------------------------------

    def list_symbols(self) -> list[Item]:
        """All persistents of the task."""
        found = [as_mapping(item) for item in self.cabinet.controller.symbols()]
        return [Item("rap-sympropers-li", item["symburl"], "", dict(item)) for item in found]

    def symbol(self, path: str, event: bool = False) -> Item:
        """Value of a persistent; `path` is task, module and name, or task and name."""
        module, name = self._place(path)
        value = self.cabinet.controller.read_symbol(module, name)
        return Item("rap-data", f"RAPID/{path}", _symbol_link(path) if event else "", {"value": value})

    def symbol_properties(self, path: str) -> Item:
        """Type and place of a persistent."""
        module, name = self._place(path)
        known = self.cabinet.controller.symbols()
        item = next(i for i in known if (i.module.lower(), i.name.lower()) == (module.lower(), name.lower()))
        return Item("rap-symproppers", f"RAPID/{path}", "", dict(as_mapping(item)))

    def write_symbol(self, path: str, form: Form, owner: str, implicit: bool) -> None:
        """Set a persistent."""
        module, name = self._place(path)
        self.rights.require_mastership(owner, implicit)
        try:
            self.cabinet.controller.write_symbol(module, name, form.get("value", ""))
        except RapidProgramError as error:
            raise RefusalError(400, CODE_INVALID, error.message) from error

    def _place(self, path: str) -> tuple[str, str]:
        task, *parts = path.split("/")
        for item in self.cabinet.controller.symbols() if task == TASK else ():
            wanted = "/".join(parts).lower()
            if wanted in (f"{item.module}/{item.name}".lower(), item.name.lower()):
                return item.module, item.name
        if self.version == 1:
            raise RefusalError(400, CODE_NO_RESOURCE, "Symbol not found")
        raise RefusalError(404, CODE_NO_SYMBOL, "Symbol not found")

    # Arm and event log -------------------------------------------------------------------------------

    def joint_target(self) -> Item:
        """Joint angles [deg]."""
        joints = {f"rax_{n}": f"{angle:.6f}" for n, angle in enumerate(self.cabinet.controller.joints(), 1)}
        return Item(
            "ms-jointtarget", "ROB_1", "", {**joints, **{f"eax_{axis}": "9E+09" for axis in "abcdef"}}
        )

    def robot_target(self, form: Form) -> Item:
        """Where the robot stands, in millimetres."""
        tool, wobj = form.get("tool", "tool0"), form.get("wobj", "wobj0")
        try:
            trans, rot, conf, _ = self.cabinet.controller.target(tool, wobj)
        except RapidProgramError as error:
            raise RefusalError(400, CODE_INVALID, error.message) from error
        values = dict(
            zip(("x", "y", "z", "q1", "q2", "q3", "q4"), (f"{v:.6f}" for v in (*trans, *rot)), strict=True)
        )
        values |= dict(zip(("cf1", "cf4", "cf6", "cfx"), (level_text(v) for v in conf), strict=True))
        return Item("ms-robtargets", "ROB_1", "", values | {f"eax{axis}": "9E+09" for axis in "abcdef"})

    def event_log(self, newest_first: bool) -> list[Item]:
        """The common log."""
        items = [_log_item(entry) for entry in self.cabinet.controller.event_log()]
        return items[::-1] if newest_first else items

    def event_log_entry(self, number: int) -> Item:
        """One entry by its number."""
        entries = self.cabinet.controller.event_log()
        if not 1 <= number <= len(entries):
            raise RefusalError(404, CODE_NO_RESOURCE, f"no event {number}")
        return _log_item(entries[number - 1])

    def _order(self, order: Callable[[], None], status: int = 403) -> None:
        try:
            order()
        except OrderRefusedError as error:
            raise RefusalError(status, CODE_WRONG_STATE, error.message) from error


def _symbol_link(path: str) -> str:
    return f"/rw/rapid/symbol/data/RAPID/{path};value"


def _log_item(entry: LogItem) -> Item:
    values = {
        "msgtype": _MESSAGE_TYPES[entry.kind],
        "code": str(entry.code),
        "src-name": TASK,
        "tstamp": time.strftime("%Y-%m-%d T %H:%M:%S", time.localtime(entry.time)),
        "title": entry.title,
        "desc": entry.text,
        "conseqs": "",
        "causes": "",
        "actions": "",
        "argc": "2",
    }
    path = f"/rw/elog/0/{entry.number}"
    return Item("elog-message-li", path, path, values, (entry.title, entry.text))


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
