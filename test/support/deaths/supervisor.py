"""Starts executables and starts again what died, as systemd or launch would."""

from __future__ import annotations

import signal
import subprocess
import threading
import time
from pathlib import Path
from typing import Any

from support.cell_processes import executable, is_renewed
from support.waiting import LIMIT

RESPAWN_DELAY = 0.5  # s
LOOK = 0.05  # s


class Supervisor:
    """A context manager; logs go to the folder.

    Args:
        folder: For logs.
        parameters: By executable.
    """

    def __init__(self, folder: Path, parameters: dict[str, dict[str, Any]]) -> None:
        self._folder = folder
        self._parameters = parameters
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self.deaths_by_themselves: list[str] = []
        self.renewed: list[str] = []  # those that said that they end so as to be started again
        self._struck: set[int] = set()

    def __enter__(self) -> Supervisor:
        for name in self._parameters:
            self._start(name)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        for process in self._processes.values():
            process.send_signal(signal.SIGCONT)
            process.send_signal(signal.SIGINT)
        for process in self._processes.values():
            try:
                process.wait(LIMIT)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def strike(self, name: str, how: signal.Signals) -> None:
        """Send a signal to an executable."""
        process = self._processes[name]
        if how == signal.SIGKILL:
            self._struck.add(process.pid)
        process.send_signal(how)

    def process(self, name: str) -> subprocess.Popen[bytes]:
        """The process of an executable as it is now."""
        return self._processes[name]

    def _start(self, name: str) -> None:
        command = [executable(name), "--ros-args"]
        for key, value in self._parameters[name].items():
            command += ["-p", f"{key}:={value}"]
        with open(self._folder / f"{name}.log", "ab") as log:
            self._processes[name] = subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder)

    def _is_renewed(self, name: str) -> bool:
        return is_renewed((self._folder / f"{name}.log").read_text(encoding="utf-8", errors="replace"))

    def _watch(self) -> None:
        while not self._ended.wait(LOOK):
            for name, process in list(self._processes.items()):
                if process.poll() is not None:
                    if process.pid not in self._struck:
                        end = f"{name} ended with {process.returncode}"
                        (self.renewed if self._is_renewed(name) else self.deaths_by_themselves).append(end)
                    time.sleep(RESPAWN_DELAY)
                    self._start(name)
