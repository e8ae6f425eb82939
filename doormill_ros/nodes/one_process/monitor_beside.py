"""The node /model_monitor beside doors whose own nodes come and go."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from types import TracebackType

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException

from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.monitor.runs_watch import RunsState
from doormill_ros.monitor.watch_state import WatchState
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.one_process.cell import CellOptions
from doormill_ros.nodes.process.spinning import SteadyExecutor

THREADS = 2
STOP_LIMIT = 2.0  # s
_LOOK = 0.2  # s


class ModelMonitorBeside:
    """A monitor in a ROS context of its own, which outlives those of the doors; a context manager.

    Args:
        folder: Of the shift: its bags, models and inspections.
        options: As of its doors.
    """

    def __init__(self, folder: Path, options: CellOptions) -> None:
        self._folder = folder.resolve()
        self._options = options
        self._context = Context()

    def __enter__(self) -> ModelMonitorBeside:
        self._folder.mkdir(parents=True, exist_ok=True)
        rclpy.init(args=self._options.arguments(RunFolder(self._folder)), context=self._context)
        self._node = ModelMonitor(context=self._context)
        self._executor = SteadyExecutor(THREADS, context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._spin, name="monitor", daemon=True)
        self._thread.start()
        self._node.bring_up()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._node.close()
        self._executor.shutdown(timeout_sec=STOP_LIMIT)
        self._thread.join(STOP_LIMIT)
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def verdict(self, limit: float) -> WatchState:
        """What the doors say once every inspection is questioned, or after so long [s].

        Raises:
            ModelStoreError: The store of models cannot be read.
        """
        deadline = time.monotonic() + limit
        state = self._node.state()
        while (state.asking or state.waiting) and time.monotonic() < deadline:
            time.sleep(_LOOK)
            state = self._node.state()
        return state

    def runs_verdict(self, limit: float) -> RunsState:
        """What the bags of all doors say by themselves, or what was known after so long [s]."""
        return self._node.runs_at_end(limit)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            pass
        except Exception:
            if self._context.ok():
                raise
