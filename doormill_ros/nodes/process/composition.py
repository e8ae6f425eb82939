"""Several nodes in this process, each with an executor of its own."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import TracebackType
from typing import Generic, TypeVar

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from doormill_ros.interrupts import is_terminated_in_order
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.run import THREADS, ignore_signals, init, leave_graph, leave_ros, shut_down
from doormill_ros.nodes.process.spinning import SteadyExecutor

STOP_LIMIT = 2.0  # s

Driver = TypeVar("Driver", bound=Node)


class Composition(Generic[Driver]):
    """Managed nodes and one node beside them that drives them; a context manager.

    When it is left, nothing of the nodes stays: what they had latched would reach the next composition
    of this process.

    Each node has the executor that it has in a process of its own. One for all would make its whole wait set anew,
    a few hundred entities of a cell, whenever any node has something to do.

    Args:
        arguments: Program name and ROS arguments.
        managed: Make the managed nodes, in the order in which they are brought up.
        beside: Makes the node that drives them.

    Attributes:
        nodes: The managed nodes.
        driver: The node beside them; there from when the composition is entered.
    """

    driver: Driver

    def __init__(
        self,
        arguments: Sequence[str],
        managed: Sequence[Callable[[], ManagedNode]],
        beside: Callable[[], Driver],
    ) -> None:
        self._arguments = arguments
        self._managed = managed
        self._beside = beside
        self.nodes: list[ManagedNode] = []
        self._all: list[Node] = []
        self._executors: list[SteadyExecutor] = []
        self._spinning: list[threading.Thread] = []

    def __enter__(self) -> Composition[Driver]:
        # Where this thread hears of signals, the context is left to the nodes that are still to be closed.
        init(
            self._arguments, SignalHandlerOptions.NO if is_terminated_in_order() else SignalHandlerOptions.ALL
        )
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop()

    def _start(self) -> None:
        for make in self._managed:
            self.nodes.append(make())
            self._all.append(self.nodes[-1])
        self.driver = self._beside()
        self._all.append(self.driver)
        for node in self._all:
            executor = SteadyExecutor(THREADS)
            executor.add_node(node)
            self._executors.append(executor)
            name = f"executor of {node.get_name()}"
            self._spinning.append(threading.Thread(target=_spin, args=(executor,), name=name, daemon=True))
            self._spinning[-1].start()
        for node in self.nodes:
            node.bring_up()

    def _stop(self) -> None:
        with _undisturbed():
            self._close()

    def _close(self) -> None:
        shut_down(self.nodes, self._executors, STOP_LIMIT)
        for thread in self._spinning:
            thread.join(STOP_LIMIT)
        leave_graph(self._all)
        self._all.clear()
        self.nodes.clear()
        leave_ros()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Let no signal interrupt the closing: what it left open would be lost. Signals are the main thread's."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = ignore_signals()
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _spin(executor: SteadyExecutor) -> None:
    # An interrupt takes the context away from under the executor.
    try:
        executor.spin()
    except ExternalShutdownException:
        pass
    except Exception:
        if rclpy.ok():
            raise
