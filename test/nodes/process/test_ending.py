"""A process of nodes ends in order, whatever signals come and however often."""

from __future__ import annotations

import signal
import subprocess
import sys
from typing import Any

import pytest
import rclpy
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options

from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import shut_down
from doormill_ros.nodes.process.spinning import SteadyExecutor
from support.waiting import LIMIT

#: Signals itself when it is up, and again while it closes; says when it has closed and when it has left the graph.
SIGNALLED = """
import signal, sys, time
from doormill_ros.nodes.process import run
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import run_nodes

class Signalled(ManagedNode):
    def __init__(self):
        super().__init__("signalled")

    def start(self):
        signal.raise_signal(int(sys.argv[1]))

    def teardown(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.raise_signal(number)
        print("closed")
        time.sleep(float(sys.argv[4]))

    def destroy_node(self):
        super().destroy_node()
        print("gone", flush=True)
        time.sleep(float(sys.argv[2]))

run.ENDING = float(sys.argv[3])
run.CLOSING = float(sys.argv[5])
sys.exit(run_nodes(Signalled, arguments=["signalled"]))
"""


class WatchedExecutor(SteadyExecutor):
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
        node, executor = ManagedNode("watched"), WatchedExecutor(2)
        executor.add_node(node)
        assert get_current_signal_handlers_options() == SignalHandlerOptions.ALL
        shut_down([node], [executor], 1.0)
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
    assert executor.waking == SignalHandlerOptions.NO


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
def test_signals_do_not_disturb_the_closing(first: signal.Signals) -> None:
    ended = _signalled(first, standing=0.0, ending=LIMIT)
    assert (ended.returncode, ended.stdout) == (0, "closed\ngone\n"), ended.stderr
    assert "Traceback" not in ended.stderr


def test_what_stands_still_after_the_closing_does_not_keep_the_process() -> None:
    ended = _signalled(signal.SIGTERM, standing=10 * LIMIT, ending=1.0)
    assert (ended.returncode, ended.stdout) == (1, "closed\ngone\n"), ended.stderr
    assert "in destroy_node" in ended.stderr


def test_a_closing_that_takes_long_says_where_it_stands_and_comes_to_its_end() -> None:
    ended = _signalled(signal.SIGINT, standing=0.0, ending=LIMIT, closing_takes=3.0, told_after=0.5)
    assert (ended.returncode, ended.stdout) == (0, "closed\ngone\n"), ended.stderr
    assert "in teardown" in ended.stderr


#: A fault of a library, while nodes spin.
FAULTY = """
import ctypes, sys
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import run_nodes

class Faulty(ManagedNode):
    def __init__(self):
        super().__init__("faulty")

    def start(self):
        ctypes.string_at(0)

sys.exit(run_nodes(Faulty, arguments=["faulty"]))
"""


def test_a_fault_of_a_library_tells_where_it_was_called_from() -> None:
    command = [sys.executable, "-c", FAULTY]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
    assert ended.returncode == -signal.SIGSEGV
    assert "in start" in ended.stderr


def _signalled(
    first: signal.Signals,
    *,
    standing: float,
    ending: float,
    closing_takes: float = 0.0,
    told_after: float = LIMIT,
) -> subprocess.CompletedProcess[str]:
    """Of a node that stands still for `standing` when it has left the graph [s]."""
    times = [standing, ending, closing_takes, told_after]
    command = [sys.executable, "-c", SIGNALLED, str(int(first)), *map(str, times)]
    return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)


#: Is told to end while it is still configured.
EARLY = """
import signal, sys, time
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import run_nodes

class Early(ManagedNode):
    def __init__(self):
        super().__init__("early")

    def setup(self):
        signal.raise_signal(signal.SIGTERM)
        while self.context.ok():
            time.sleep(0.01)
        self.publisher(topics.RUN_RESULT)

sys.exit(run_nodes(Early, arguments=["early"]))
"""


def test_what_a_node_meets_that_is_ended_while_it_is_configured_is_no_fault() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", EARLY], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert ended.returncode == 0
    assert "Traceback" not in ended.stderr
    assert "could not configure" not in ended.stderr


#: What rclpy still has installed while nodes close, and after that.
ENDED = """
import sys
from doormill_ros.nodes.process.composition import Composition
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import run_nodes
from rclpy.node import Node
from rclpy.signals import get_current_signal_handlers_options as installed

class Asking(ManagedNode):
    def __init__(self):
        super().__init__("asking")

    def start(self):
        if sys.argv[1] == "run_nodes":
            raise KeyboardInterrupt

    def teardown(self):
        print(installed().name)

if sys.argv[1] == "run_nodes":
    run_nodes(Asking, arguments=["asking"])
else:
    for _ in range(2):
        with Composition(["composed"], [Asking], lambda: Node("beside")):
            print(installed().name)
print(installed().name)
"""


@pytest.mark.parametrize(
    ("how", "installed"), [("run_nodes", ["NO", "NO"]), ("composition", ["ALL", "NO", "ALL", "NO", "NO"])]
)
def test_what_rclpy_installed_is_gone_before_nodes_close(how: str, installed: list[str]) -> None:
    """Its thread has ended then; handlers that are replaced before it takes them back stay, and so does the thread."""
    ended = subprocess.run(
        [sys.executable, "-c", ENDED, how], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert (ended.returncode, ended.stdout.split()) == (0, installed), ended.stderr


#: The same for nodes in the process of a command, which goes on afterwards.
COMPOSED = """
import signal
from doormill_ros.nodes.process.composition import Composition
from doormill_ros.nodes.base.managed_node import ManagedNode
from rclpy.node import Node

class Signalled(ManagedNode):
    def __init__(self):
        super().__init__("signalled")

    def teardown(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.raise_signal(number)
        print("closed")

# Python has this handler only where the process was not started with SIGINT ignored, as in the background.
before = signal.default_int_handler
signal.signal(signal.SIGINT, before)
with Composition(["composed"], [Signalled], lambda: Node("beside")):
    pass
print(signal.getsignal(signal.SIGINT) is before)
"""


def test_signals_do_not_disturb_the_closing_of_a_composition() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", COMPOSED], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert (ended.returncode, ended.stdout) == (0, "closed\nTrue\n"), ended.stderr


#: Closes again and again, as nodes that were interrupted do.
CLOSING_AGAIN = """
import signal
import rclpy
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda *_: None)
from doormill_ros.nodes.process.run import STOP_LIMIT, ignore_signals, leave_ros, shut_down
rclpy.init()
print("closing", flush=True)
for _ in range(20000):
    ignore_signals()
    shut_down([], [], STOP_LIMIT)
    leave_ros()
print("closed")
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_no_moment_of_the_closing_leaves_a_signal_to_its_default_action(number: signal.Signals) -> None:
    """Rclpy, asked to take back handlers that it has not installed, gives signals their default action meanwhile."""
    command = [sys.executable, "-c", CLOSING_AGAIN]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == "closing\n"
            while process.poll() is None:
                process.send_signal(number)
            assert (process.returncode, process.stdout.read()) == (0, "closed\n")
        finally:
            process.kill()
