"""Start nodes, alone or together, and spin them until they are told to stop."""

from __future__ import annotations

import atexit
import contextlib
import faulthandler
import gc
import re
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidNamespaceException
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import (
    SignalHandlerOptions,
    get_current_signal_handlers_options,
    uninstall_signal_handlers,
)
from rclpy.validate_namespace import validate_namespace

from doormill_ros.cell.errors import BadParameterError, RosArgumentsError
from doormill_ros.errors import one_line
from doormill_ros.interrupts import interrupt_once
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.allocator import set_allocator
from doormill_ros.nodes.process.dds_settings import repair_soon
from doormill_ros.nodes.process.help_page import HELP, NODES_FILE, help_page, words_apart
from doormill_ros.nodes.process.mailboxes import Mailboxes
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.nodes.process.unknown_parameters import unknown_nodes, unknown_parameters
from doormill_ros.resources import resource

THREADS = 4  #: of a node's executor
STOP_LIMIT = 1.0  # s
#: What DDS and the interpreter may take for their end once nodes have closed; then the process ends without them [s].
ENDING = 20.0
#: After so long it is told where the closing stands [s]; it may go on, files are written meanwhile.
CLOSING = 60.0
BAD_ARGUMENTS = 2  #: exit status after which nobody starts the node again
_PLACE_IN_RCL = re.compile(r",? at /\S+:\d+")


def init(
    arguments: Sequence[str],
    handlers: SignalHandlerOptions = SignalHandlerOptions.ALL,
    keep_freed: bool = True,
) -> None:
    """Initialize rclpy with the shipped parameter file and the user's ROS arguments.

    Args:
        arguments: Program name and ROS arguments.
        handlers: Signals at which rclpy takes the context away.
        keep_freed: See `run_nodes`.

    Raises:
        RosArgumentsError: They cannot be read.
    """
    set_allocator(keep_freed)
    repair_soon()
    program, *rest = list(arguments)
    with _told_of_arguments():
        rclpy.init(args=[program, *_shipped(), *rest], signal_handler_options=handlers)


def check_start(namespace: str) -> None:
    """Find out whether nodes can be started here, before anything makes way for them.

    Args:
        namespace: Of the nodes, such as "/cell1"; empty: none.

    Raises:
        RosArgumentsError: ROS 2 does not take the namespace, its environment, such as its domain, or the file of
            parameters.
    """
    context = Context()
    with _told_of_arguments():
        if namespace:
            validate_namespace(namespace)
        rclpy.init(args=["", *_shipped()], context=context, signal_handler_options=SignalHandlerOptions.NO)
    context.try_shutdown()


def _shipped() -> list[str]:
    return ["--ros-args", "--params-file", str(resource(NODES_FILE)), "--"]


@contextlib.contextmanager
def _told_of_arguments() -> Iterator[None]:
    """Say in one sentence what ROS 2 does not take."""
    try:
        yield
    except rclpy_implementation.UnknownROSArgsError as error:
        raise RosArgumentsError(
            f"{error} after --ros-args is nothing that ROS 2 knows; correct it on the command line"
        ) from error
    except InvalidNamespaceException as error:
        raise RosArgumentsError(f"{error}; correct the namespace") from error
    except rclpy_implementation.RCLError as error:
        reason = one_line(_PLACE_IN_RCL.sub("", str(error)))
        raise RosArgumentsError(
            f"{reason}; correct the arguments after --ros-args on the command line, or the parameter file"
        ) from error


def run_nodes(
    *factories: Callable[[], ManagedNode], arguments: Sequence[str] | None = None, keep_freed: bool = True
) -> int:
    """Run nodes in this process until interrupted; the body of every node's executable.

    Args:
        factories: Make the nodes.
        arguments: Program name, --help, and what ROS 2 takes; None for those of the process.
        keep_freed: A door waits for these nodes: their allocator gives nothing back to the system.

    Returns:
        Exit status.
    """
    interrupt_once()
    # A library's fault that kills the process tells where it was called from.
    faulthandler.enable(sys.__stderr__ or 2)
    arguments = sys.argv if arguments is None else arguments
    program, own = Path(arguments[0]).name, words_apart(arguments[1:])[0]
    if any(word in HELP for word in own):
        sys.stdout.write(help_page(program, factories) + "\n")
        return 0
    if own:
        get_logger("doormill").fatal(
            f"{program} does not take {own[0]!r}; parameters are given as --ros-args -p NAME:=VALUE, "
            f"{program} --help tells which there are"
        )
        return BAD_ARGUMENTS
    try:
        init(arguments, keep_freed=keep_freed)
    except RosArgumentsError as error:
        get_logger("doormill").fatal(error.message)
        return BAD_ARGUMENTS
    executor = SteadyExecutor(THREADS, look=Mailboxes().look)
    nodes: list[ManagedNode] = []
    try:
        for factory in factories:
            nodes.append(factory())
            executor.add_node(nodes[-1])
            nodes[-1].bring_up()
        for sentence in [*unknown_parameters(nodes), *unknown_nodes(arguments, nodes)]:
            get_logger("doormill").warning(sentence)
        _spare_collector()
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except BadParameterError as error:
        get_logger("doormill").fatal(error.message)
        return BAD_ARGUMENTS
    except Exception:
        # What is met while the context goes away is the way out, no fault.
        if rclpy.ok():
            raise
    finally:
        # An interrupt that another thread took may be told to this one only now; it is told once.
        try:
            ignore_signals()
        except KeyboardInterrupt:
            ignore_signals()
        faulthandler.dump_traceback_later(CLOSING, file=sys.__stderr__ or 2)
        for node in nodes:
            node.leave()
        shut_down(nodes, [executor], STOP_LIMIT)
        # Files are closed and signals dropped: what stands still from here on holds nothing but the process.
        _limit_ending()
        leave_graph(nodes)
        leave_ros()
        faulthandler.cancel_dump_traceback_later()
        atexit.register(_limit_ending)
    return 0


def shut_down(nodes: Sequence[ManagedNode], executors: Sequence[SteadyExecutor], timeout: float) -> None:
    """Let each node close its files and drop its signals, then end the executors' threads.

    Also when the context is already gone.
    """
    for executor in executors:
        executor.expect_closing()
    for node in nodes:
        node.close()
    # Its thread for signals wakes an executor through a guard condition that it holds no lock on.
    # Destroyed meanwhile, that is a segmentation fault: the thread has to end first.
    _take_signals_back()
    for executor in executors:
        executor.shutdown(timeout_sec=timeout)


def leave_graph(nodes: Sequence[Node]) -> None:
    """Destroy nodes whose executors have ended, the last first.

    rclpy does so only where no signal took the context away. Left to the interpreter's end, threads of DDS meet what
    is destroyed there already: the process dies of a segmentation fault or stands still.
    """
    for node in reversed(nodes):
        with contextlib.suppress(Exception):
            node.destroy_node()


def ignore_signals() -> dict[signal.Signals, Any]:
    """Let no signal disturb what follows; to be called by the main thread.

    Returns:
        The handlers that stood before rclpy and this, by signal.
    """
    # rclpy takes back only handlers that it still finds in their place; its thread would stay with them.
    _take_signals_back()
    return {number: signal.signal(number, signal.SIG_IGN) for number in (signal.SIGINT, signal.SIGTERM)}


def leave_ros() -> None:
    """Take the context away, once signals are taken back from rclpy."""
    rclpy.try_shutdown(uninstall_handlers=False)


def _take_signals_back() -> None:
    """Let rclpy hear of no signal any more.

    Asked when it hears of none, it gives each signal its default action for a moment, even one that is ignored: an
    interrupt in that moment kills the process.
    """
    if get_current_signal_handlers_options() != SignalHandlerOptions.NO:
        uninstall_signal_handlers()


def _limit_ending() -> None:
    """End the process with the stacks of its threads, unless it ends within `ENDING` or this is taken back."""
    faulthandler.dump_traceback_later(ENDING, exit=True, file=sys.__stderr__ or 2)


def _spare_collector() -> None:
    """Take everything made until now, modules above all, out of the garbage collector's rounds.

    What the start left behind is young; to look through all that is old, too, takes as long as a message's import.
    """
    gc.collect(1)
    gc.freeze()
