"""What Ctrl-C and SIGTERM do to a process: end it, in order where there is something to close, without a traceback."""

from __future__ import annotations

import atexit
import functools
import signal
import sys
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import ParamSpec

_WORD = "interrupted\n"


#: What a shell shows of a process that ended of an interrupt.
INTERRUPTED = 128 + signal.SIGINT

P = ParamSpec("P")


class Terminated(SystemExit):
    """SIGTERM, told to the main thread; ends the process with the status that a shell shows of that signal."""

    def __init__(self) -> None:
        super().__init__(128 + signal.SIGTERM)


def die_of_interrupts() -> None:
    """Let an interrupt kill the process, as SIGTERM does, while there is nothing to close.

    An exception amid imports would show all of them; and a module may swallow it or make another one of it.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interruptible(main: Callable[P, int]) -> Callable[P, int]:
    """Let the main function of a command line tool end of an interrupt in one word and with status 130.

    After `interrupt_once` the process tells of it itself.
    """

    @functools.wraps(main)
    def run(*args: P.args, **kwargs: P.kwargs) -> int:
        try:
            return main(*args, **kwargs)
        except KeyboardInterrupt:
            if sys.excepthook is _tell:
                raise
            sys.stderr.write(_WORD)
            return INTERRUPTED

    return run


def interrupt_once(numbers: Sequence[signal.Signals] = (signal.SIGINT,)) -> None:
    """Let the first of these signals end the process in order and the ones after it wait for that.

    Under `ros2 launch` a Ctrl-C comes twice, from the terminal and from launch. To be called by a
    process' main thread before rclpy.init, whose own handler passes the signal on.
    """
    interrupted = False

    def end(number: int, _: object) -> None:
        nonlocal interrupted
        if not interrupted:
            interrupted = True
            raise KeyboardInterrupt if number == signal.SIGINT else Terminated

    sys.excepthook = _tell
    for number in numbers:
        signal.signal(number, end)
        # The interpreter takes that handler away on its way out; a signal ignored stays ignored.
        atexit.register(signal.signal, number, signal.SIG_IGN)


def is_terminated_in_order() -> bool:
    """SIGTERM is told to the main thread."""
    return callable(signal.getsignal(signal.SIGTERM))


def _tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Say in one line that the user ended it; the interpreter then dies of the signal, as shells expect."""
    if issubclass(kind, KeyboardInterrupt):
        sys.stderr.write(_WORD)
    else:
        sys.__excepthook__(kind, error, trace)
