"""What stands around the nodes that are timed: the simulated camera, and a controller that takes each file at once.

Started as a process of its own. No RAPID program is interpreted and nothing is milled: that would take a core from the
nodes, which no cell's controller does, and two to six seconds a door.
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from doormill_interfaces.msg import DoorPlacement
from doormill_ros.abb import signals
from doormill_ros.files import write_atomically
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.process.dds_settings import make_room_for_pictures
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.simulated.camera_simulator import CameraSimulator
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo

POLL = 0.002  # s
LIMIT = 60.0  # s


class ReadyHand(ManagedNode):
    """Asks for a file as soon as a door is clamped, reads it when it is announced, and reports the end at once."""

    PARAMETERS = (NodeParameter("home", "out/controller/HOME", "folder behind the controller's HOME:"),)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("ready_hand", **kwargs)

    def setup(self) -> None:
        """Take the folder; subscribe."""
        self._home = Path(self.value("home"))
        self._port = FolderIo(self._home)
        self._number, self._run_id = 0, ""
        self.subscribe(topics.DOOR_PLACEMENT, self._clamped)

    def _clamped(self, placement: DoorPlacement) -> None:
        if placement.run_id != self._run_id:
            self._run_id = placement.run_id
            threading.Thread(target=self.guarded(self._take), daemon=True).start()

    def _take(self) -> None:
        self._number = self._number % signals.LARGEST_NUMBER + 1
        mark = f"{self._number}\n"
        self._port.write(signals.DONE, 0)
        write_atomically(self._home / signals.REQUEST_FILE, mark)
        self._port.write(signals.REQUEST, 1)
        self._wait(signals.READY_NUMBER, self._number)
        self._wait(signals.READY, 1)
        (self._home / signals.TARGET_FILE).read_bytes()
        run_id = (self._home / signals.ORDER_FILE).read_text().split("\n")[0]
        write_atomically(self._home / signals.ACCEPTED_FILE, f"{run_id}\n{mark}")
        self._port.write(signals.REQUEST, 0)
        self._wait(signals.READY, 0)
        write_atomically(self._home / signals.MILLED_FILE, f"{run_id}\n")
        self._port.write(signals.DONE, 1)

    def _wait(self, name: str, value: int) -> None:
        end = time.monotonic() + LIMIT
        while self._port.read(name) != value:
            if time.monotonic() > end:
                raise TimeoutError(f"{name} did not become {value}")
            time.sleep(POLL)


if __name__ == "__main__":
    make_room_for_pictures()
    sys.exit(run_nodes(CameraSimulator, ReadyHand))
