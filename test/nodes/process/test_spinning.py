"""Timers destroyed by one thread while the executor looks at them in another, and an executor that stands still."""

import gc
import subprocess
import sys
import threading
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.timer import Timer

from doormill_ros.nodes.process import spinning
from doormill_ros.nodes.process.spinning import SteadyExecutor
from support.waiting import LIMIT


class Doomed(Timer):
    """A timer that is destroyed between the two questions of an executor: did the wait find it ready, is it still.

    That is what another thread does to it once in a great many rounds; here it happens in the first.
    """

    asked = destroyed = False

    @property
    def handle(self):
        handle = super().handle
        asking = sys._getframe(1)
        ready = asking.f_locals.get("timers_ready", ())
        if asking.f_code.co_name == "_wait_for_ready_callbacks" and not self.destroyed:
            if self.asked:
                handle.destroy_when_not_in_use()
                self.destroyed = True
            self.asked = handle.pointer in ready
        return handle


class Destroying(Node):
    """Counts beside a timer that is doomed."""

    def __init__(self) -> None:
        super().__init__("destroying")
        self.counted = 0
        self.told = threading.Event()
        self.create_timer(0.02, self._count)
        self.doomed = self.create_timer(0.02, lambda: None)
        self.doomed.__class__ = Doomed

    def _count(self) -> None:
        self.counted += 1
        if self.doomed.destroyed and self.counted > 5:
            self.told.set()


@pytest.fixture
def context() -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.try_shutdown()


def spun(executor: MultiThreadedExecutor, node: Node) -> tuple[threading.Thread, list[BaseException]]:
    executor.add_node(node)
    errors: list[BaseException] = []

    def run() -> None:
        try:
            executor.spin()
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread, errors


def test_an_executor_of_rclpy_ends_there(context) -> None:
    # What the class is for: on the day that rclpy holds on to what it looks at, half of it can go.
    executor = MultiThreadedExecutor(num_threads=2)
    thread, errors = spun(executor, Destroying())
    thread.join(LIMIT)
    assert not thread.is_alive()
    assert [type(error) for error in errors] == [rclpy_implementation.RCLError]
    executor.shutdown()


def test_the_other_callbacks_go_on(context) -> None:
    executor, node = SteadyExecutor(2), Destroying()
    thread, errors = spun(executor, node)
    assert node.told.wait(LIMIT), f"{node.counted} calls"
    assert errors == []
    executor.shutdown()
    thread.join(LIMIT)
    assert not thread.is_alive()


@pytest.mark.parametrize("closing", [False, True])
def test_what_is_destroyed_is_told_unless_its_own_nodes_are_taken_apart(
    context, monkeypatch: pytest.MonkeyPatch, closing: bool
) -> None:
    said: list[str] = []
    logger = SimpleNamespace(warning=said.append, error=said.append)
    monkeypatch.setattr(spinning, "get_logger", lambda name: logger)
    executor, node = SteadyExecutor(2), Destroying()
    if closing:
        executor.expect_closing()
    thread, errors = spun(executor, node)
    assert node.told.wait(LIMIT), f"{node.counted} calls"
    executor.shutdown()
    thread.join(LIMIT)
    assert errors == []
    assert bool([line for line in said if "the executor goes on" in line]) is not closing


class Broken(Node):
    """Raises whenever it is looked at."""

    @property
    def timers(self) -> Iterator:
        raise rclpy_implementation.InvalidHandle("gone")


def test_what_does_not_end_is_told(context) -> None:
    executor = SteadyExecutor(2)
    thread, errors = spun(executor, Broken("broken"))
    thread.join(LIMIT)
    assert not thread.is_alive()
    assert [type(error) for error in errors] == [rclpy_implementation.InvalidHandle]
    executor.shutdown()


def test_a_context_taken_away_ends_it(context) -> None:
    executor = SteadyExecutor(2)
    thread, _ = spun(executor, Node("quiet"))
    rclpy.try_shutdown()
    thread.join(LIMIT)
    assert not thread.is_alive()
    executor.shutdown()


class Failing(Node):
    """Raises in a callback that lasts until the executor is shut down."""

    def __init__(self, kind: type[Exception]) -> None:
        super().__init__("failing")
        self.called, self.go_on = threading.Event(), threading.Event()
        self._kind = kind
        self.create_timer(0.01, self._call)

    def _call(self) -> None:
        self.called.set()
        self.go_on.wait(LIMIT)
        raise self._kind("at the end")


@pytest.mark.parametrize(("kind", "told"), [(rclpy_implementation.InvalidHandle, 0), (ValueError, 1)])
def test_what_is_raised_at_the_end_is_told_once(context, capfd, kind: type[Exception], told: int) -> None:
    executor, node = SteadyExecutor(2), Failing(kind)
    thread, errors = spun(executor, node)
    assert node.called.wait(LIMIT)
    ending = threading.Thread(target=executor.shutdown)
    ending.start()
    thread.join(LIMIT)
    assert not thread.is_alive()
    node.go_on.set()
    ending.join(LIMIT)
    node.destroy_node()
    del executor, node
    gc.collect()
    said = "".join(capfd.readouterr())
    assert errors == []
    assert said.count("at the end") == told
    assert "never retrieved" not in said


STANDING = """
import threading
import rclpy
from rclpy.node import Node
from doormill_ros.nodes.process import spinning
from doormill_ros.nodes.process.spinning import SteadyExecutor

def waits_for_ever():
    threading.Event().wait()

rclpy.init()
node = Node("standing")
node.create_timer(0.01, waits_for_ever)
executor = SteadyExecutor(2, still=2.0)
executor.add_node(node)
executor.spin()
"""


def test_a_process_that_stands_still_says_where_and_ends() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", STANDING], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert ended.returncode != 0
    assert "waits_for_ever" in ended.stderr
    assert "No callback of this process was called for 2 s" in ended.stderr + ended.stdout


IDLE = """
import threading
import rclpy
from rclpy.node import Node
from doormill_ros.nodes.process.spinning import SteadyExecutor

rclpy.init()
node = Node("idle", start_parameter_services=False)
called = threading.Event()
executor = SteadyExecutor(2, still=0.5)
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
spinning.start()
executor.create_task(lambda: None)
threading.Event().wait(3.0)
executor.create_task(called.set)
print("lives" if called.wait(30.0) else "is dead", flush=True)
executor.shutdown()
spinning.join()
node.destroy_node()
rclpy.try_shutdown()
"""


def test_a_process_that_has_nothing_to_do_lives() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", IDLE], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert (ended.returncode, ended.stdout) == (0, "lives\n"), ended.stderr


class Stuck(Node):
    """Never lets go of the thread that looks what is ready."""

    @property
    def timers(self) -> Iterator:
        threading.Event().wait()
        return iter(())


def test_an_executor_that_cannot_look_what_is_ready_is_found(
    context, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = threading.Event()
    monkeypatch.setattr(SteadyExecutor, "_give_up", lambda self: (found.set(), self._ended.set()))
    monkeypatch.setattr(spinning.faulthandler, "dump_traceback", lambda *_, **__: None)
    executor, node = SteadyExecutor(2, still=0.5), Stuck("stuck")
    spun(executor, node)
    assert found.wait(LIMIT)


@pytest.mark.parametrize("kind", [SteadyExecutor, MultiThreadedExecutor])
def test_what_is_ready_in_the_moment_of_the_shutdown_ends_nothing_in_tears(context, kind) -> None:
    """The pool is shut down between the question what is ready and its being handed over; rclpy's own raises there."""
    executor = kind(2)
    node = Node("late")
    pool = executor._executor
    ready = node.create_timer(0.01, lambda: None)
    submit = pool.submit

    def shut_down_first(*arguments):
        executor.shutdown()
        return submit(*arguments)

    pool.submit = shut_down_first
    thread, errors = spun(executor, node)
    thread.join(LIMIT)
    assert not thread.is_alive()
    assert ready.timer_period_ns
    raised = kind is MultiThreadedExecutor
    assert [str(error) for error in errors] == ["cannot schedule new futures after shutdown"] * raised
