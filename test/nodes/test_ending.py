"""A process of nodes ends in order, whatever signals come and however often."""

from __future__ import annotations

import signal
import subprocess
import sys
from typing import Any

import pytest
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options

from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.nodes.run import shut_down

LIMIT = 120.0  # s

#: Signals itself when it is up, and again while it closes; says when it has closed.
SIGNALLED = """
import signal, sys
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.nodes.run import run_nodes

class Signalled(ManagedNode):
    def __init__(self):
        super().__init__("signalled")

    def start(self):
        signal.raise_signal(int(sys.argv[1]))

    def teardown(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.raise_signal(number)
        print("closed")

sys.exit(run_nodes(Signalled, arguments=["signalled"]))
"""


class WatchedExecutor(MultiThreadedExecutor):  # type: ignore[misc]  # rclpy has no types
    """Notes which signals could still wake it when it is shut down."""

    waking: SignalHandlerOptions | None = None

    def shutdown(self, *args: Any, **kwargs: Any) -> bool:
        self.waking = get_current_signal_handlers_options()
        ended: bool = super().shutdown(*args, **kwargs)
        return ended


def test_no_signal_wakes_an_executor_that_is_being_destroyed() -> None:
    """Rclpy's thread for signals would read what is destroyed, and the process die of it."""
    rclpy.init()
    try:
        node, executor = ManagedNode("watched"), WatchedExecutor(num_threads=2)
        executor.add_node(node)
        assert get_current_signal_handlers_options() == SignalHandlerOptions.ALL
        shut_down([node], executor, 1.0)
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
    assert executor.waking == SignalHandlerOptions.NO


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
def test_signals_do_not_disturb_the_closing(first: signal.Signals) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", SIGNALLED, str(int(first))], capture_output=True, text=True, timeout=LIMIT
    )
    assert (ended.returncode, ended.stdout) == (0, "closed\n"), ended.stderr
    assert "Traceback" not in ended.stderr
