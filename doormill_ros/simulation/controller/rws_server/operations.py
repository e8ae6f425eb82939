"""What a client may ask of the cabinet, free of paths and spellings of either version."""

from __future__ import annotations

import os
import shutil
import time
from pathlib import Path

from doormill_ros.simulation.controller.rws_server.cabinet import AccessLevel, Cabinet, SimulatedSignal
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_ACCESS_REJECTED,
    CODE_BAD_REQUEST,
    CODE_NO_MASTERSHIP,
    CODE_NOT_FOUND,
    Item,
    RefusalError,
)

Form = dict[str, str]


class Operations:
    """Reads and changes of one cabinet; raises `RefusalError` as the controller would answer."""

    def __init__(self, cabinet: Cabinet) -> None:
        self.cabinet = cabinet

    # Signals -------------------------------------------------------------------------------------

    def signal(self, path: str) -> SimulatedSignal:
        """The signal at a path of the tree."""
        signal = self.cabinet.find_signal(path)
        if signal is None:
            raise RefusalError(404, CODE_NOT_FOUND, f"signal {path} not found")
        return signal

    def signal_item(self, signal: SimulatedSignal, kind: str = "ios-signal-li", suffix: str = "") -> Item:
        """A signal with its value."""
        level = str(self.cabinet.value(signal.name))
        values = {
            "name": signal.name,
            "type": "DO",
            "category": "",
            "lvalue": level,
            "lstate": "not simulated",
        }
        if kind == "ios-signalstate-ev":
            values = {"lvalue": level, "lstate": "not simulated"}
        return Item(kind, signal.path, f"/rw/iosystem/signals/{signal.path}{suffix}", values)

    def list_signals(self) -> list[Item]:
        """All signals."""
        return [self.signal_item(s) for s in self.cabinet.signals.values()]

    def write_signal(self, path: str, form: Form) -> None:
        """Set a signal, if its access level allows."""
        signal = self.signal(path)
        mode, value = form.get("mode", "value"), form.get("lvalue", "")
        if mode not in ("value", "invert", "toggle") or (mode == "value" and value not in ("0", "1")):
            raise RefusalError(400, CODE_BAD_REQUEST, f"invalid mode {mode!r} or lvalue {value!r}")
        if signal.access is not AccessLevel.ALL:
            raise RefusalError(
                403, CODE_ACCESS_REJECTED, "SYS_CTRL_E_IO_ACCESS: access to the signal rejected"
            )
        level = int(value) if mode == "value" else 1 - self.cabinet.value(signal.name)
        self.cabinet.set_value(signal.name, level)

    # Files -----------------------------------------------------------------------------------------

    def path(self, relative: str) -> Path:
        """A path inside HOME; what would leave it does not exist."""
        home = self.cabinet.home.resolve()
        path = (home / relative).resolve()
        if path != home and home not in path.parents:
            raise RefusalError(404, CODE_NOT_FOUND, "no such file")
        return path

    def read_file(self, relative: str) -> bytes:
        """A file's bytes."""
        path = self.path(relative)
        if not path.is_file():
            raise RefusalError(404, CODE_NOT_FOUND, f"no such file {relative}")
        return path.read_bytes()

    def list_folder(self, relative: str) -> list[Item]:
        """Entries of a folder."""
        items = []
        for entry in sorted(os.scandir(self.path(relative)), key=lambda e: e.name):
            stat = entry.stat()
            date = time.strftime("%Y-%m-%d T %H:%M:%S", time.localtime(stat.st_mtime))
            kind = "fs-dir" if entry.is_dir() else "fs-file"
            values = (
                {"fs-mdate": date} if entry.is_dir() else {"fs-size": str(stat.st_size), "fs-mdate": date}
            )
            items.append(Item(kind, entry.name, entry.name, values))
        return items

    def write_file(self, relative: str, data: bytes) -> bool:
        """Write in place, as the controller does: not atomic. True when the file is new."""
        path = self.path(relative)
        if not path.parent.is_dir():
            raise RefusalError(404, CODE_NOT_FOUND, "no such folder")
        new = not path.exists()
        try:
            with path.open("wb") as file:
                half = len(data) // 2
                file.write(data[:half])
                file.flush()
                file.write(data[half:])
        except OSError as error:
            raise RefusalError(500, CODE_BAD_REQUEST, f"write failed: {error.strerror}") from error
        return new

    def delete(self, relative: str) -> None:
        """Remove a file or folder."""
        path = self.path(relative)
        if not path.exists():
            raise RefusalError(404, CODE_NOT_FOUND, f"no such file {relative}")
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    def make_folder(self, relative: str, name: str) -> None:
        """Create a folder."""
        if not name or "/" in name:
            raise RefusalError(400, CODE_BAD_REQUEST, "fs-newname missing")
        self.path(f"{relative}/{name}".lstrip("/")).mkdir(exist_ok=True)

    # RAPID and panel ---------------------------------------------------------------------------

    def execution(self) -> Item:
        """State of the RAPID execution."""
        return Item(
            "rap-execution", "execution", "", {"ctrlexecstate": self.cabinet.execution, "cycle": "forever"}
        )

    def control_execution(self, action: str) -> None:
        """Start, stop, or move the program pointer to main."""
        if action == "resetpp" and self.cabinet.execution == "running":
            raise RefusalError(403, CODE_BAD_REQUEST, "program pointer cannot be moved while running")
        if action == "start" and self.cabinet.ctrlstate != "motoron":
            raise RefusalError(403, CODE_BAD_REQUEST, "motors are off")
        self.cabinet.execution = {"start": "running", "stop": "stopped"}.get(action, self.cabinet.execution)

    def tasks(self) -> list[Item]:
        """The one motion task."""
        state = "started" if self.cabinet.execution == "running" else "stopped"
        values = {"name": "T_ROB1", "type": "normal", "taskstate": "linked", "excstate": state}
        return [Item("rap-task-li", "T_ROB1", "", {**values, "active": "On", "motiontask": "TRUE"})]

    def panel(self, what: str) -> Item:
        """State of motors or operating mode."""
        key = what.replace("-", "")
        value = {"ctrlstate": self.cabinet.ctrlstate, "opmode": self.cabinet.opmode}[key]
        return Item(f"pnl-{key}", key, "", {key: value})

    def set_motors(self, form: Form) -> None:
        """Motors on or off."""
        if form.get("ctrl-state") not in ("motoron", "motoroff"):
            raise RefusalError(400, CODE_BAD_REQUEST, "ctrl-state missing")
        self.cabinet.ctrlstate = form["ctrl-state"]

    def symbol(self, path: str) -> Item:
        """Value of a RAPID variable."""
        if path not in self.cabinet.symbols:
            raise RefusalError(404, CODE_NOT_FOUND, f"symbol {path} not found")
        return Item("rap-data", f"RAPID/{path}", "", {"value": self.cabinet.symbols[path]})

    def write_symbol(self, path: str, form: Form, implicit_mastership: bool = False) -> None:
        """Set a RAPID variable; needs mastership."""
        self.symbol(path)
        if not (self.cabinet.mastership or implicit_mastership):
            raise RefusalError(400, CODE_NO_MASTERSHIP, "mastership is not held")
        self.cabinet.symbols[path] = form.get("value", "")

    def mastership(self, action: str) -> None:
        """Take or give back mastership."""
        if action == "request" and self.cabinet.mastership:
            raise RefusalError(403, CODE_NO_MASTERSHIP, "mastership is held by another client")
        self.cabinet.mastership = action == "request"
