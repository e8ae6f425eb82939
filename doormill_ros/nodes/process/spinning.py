"""An executor that goes on whatever is destroyed meanwhile, and that does not stand still unseen."""

from __future__ import annotations

import contextlib
import faulthandler
import inspect
import os
import signal
import sys
import threading
import time
from collections.abc import Callable

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import get_logger

#: So many errors in a row, each within `CALM` of the one before, are no chance meetings.
MANY = 100
CALM = 1.0  # s
#: An executor whose callback lasts for so long, or that does not turn though it is woken, never will again [s].
STILL = 300.0
#: What an interrupt does not end within this is ended without asking [s].
ENDING = 20.0


class SteadyExecutor(MultiThreadedExecutor):  # type: ignore[misc]  # rclpy has no types
    """Executes callbacks in a pool of threads, as its base class.

    rclpy asks timers and subscriptions that its wait found ready what they hold, and holds no lock on them: one that
    another thread destroyed in between raises out of `spin`. Left at that, all nodes of the process stand still for
    ever, while DDS' own threads keep telling everybody that they live.

    Args:
        threads: Of the pool, two or more.
        still: Process time without a turn after which the process is ended, so that what started it can start it
            again [s]; the stacks of all threads go to stderr first. Time in which the process is stopped does not
            count. One that has nothing to do is woken, which is a turn.
        context: Of its nodes; None for the default one.
        look: Asked a hundred times as often; when it tells a reason the process is ended, too.
    """

    def __init__(
        self,
        threads: int,
        still: float = STILL,
        context: Context | None = None,
        look: Callable[[], str] = str,
    ) -> None:
        super().__init__(num_threads=threads, context=context)
        self._look = look
        self._errors = 0
        self._last_error = -CALM
        self._turns = 0
        self._closing = False
        self._ended = threading.Event()
        threading.Thread(target=self._watch, args=(still,), name="turns", daemon=True).start()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """See the base class.

        Raises:
            InvalidHandle, RCLError: They do not end.
            ExternalShutdownException: The context was taken away.
        """
        self._turns += 1
        try:
            super().spin_once(timeout_sec)
        except ExternalShutdownException:
            raise
        except (rclpy_implementation.InvalidHandle, rclpy_implementation.RCLError) as error:
            if not self.context.ok():
                raise ExternalShutdownException from error
            now = time.monotonic()
            self._errors = self._errors + 1 if now - self._last_error < CALM else 1
            self._last_error = now
            if self._errors >= MANY:
                raise
            if not self._closing:
                get_logger("doormill").warning(
                    f"{error!r}: the executor goes on; whatever was destroyed meanwhile is lost, nothing else"
                )
        except RuntimeError:
            # The pool takes nothing more once it is shut down; what was ready in that moment is not called.
            if not self._ended.is_set():
                raise

    def expect_closing(self) -> None:
        """From here on nodes are taken apart under it: what is gone meanwhile is worth no word."""
        self._closing = True

    def shutdown(self, *args: object, **kwargs: object) -> bool:
        """See the base class; what raised in a callback and was not told by `spin` is told here."""
        self._ended.set()
        complete = bool(super().shutdown(*args, **kwargs))
        for future in self._futures:
            # Left alone, it would be printed whenever the interpreter happens to collect it.
            error = future.exception() if future.done() else None
            # Whoever was called after the base class took its guard away finds it gone.
            if error is not None and not isinstance(error, rclpy_implementation.InvalidHandle):
                get_logger("doormill").error(f"{error!r} in a callback while the executor was shut down")
        for task, *_ in self._tasks:
            # Python warns of a coroutine that nobody started; these were ready when the pool took nothing more.
            if (
                inspect.iscoroutine(task._handler)
                and inspect.getcoroutinestate(task._handler) == "CORO_CREATED"
            ):
                task._handler.close()
        return complete

    def _watch(self, still: float) -> None:
        seen, since, woken = -1, 0.0, False
        period = still / 100
        # Periods are counted, not the clock: it runs on while the process is stopped.
        while not self._ended.wait(period):
            turns = self._turns
            stands = turns == seen and turns > 0
            since, woken = (since + period, woken) if stands else (0.0, False)
            seen = turns
            executing = any(task.executing() for task in self._futures[:])
            if since >= still / 2 and not woken and not executing:
                woken = True
                # It may be shut down in this moment.
                with contextlib.suppress(rclpy_implementation.InvalidHandle):
                    self.create_task(lambda: None)
            elif since >= still and (woken or executing):
                get_logger("doormill").fatal(
                    f"No callback of this process was called for {still:g} s; it ends, so that it can be started "
                    "again. The stacks of its threads follow; hand them in."
                )
                faulthandler.dump_traceback(sys.__stderr__ or 2, all_threads=True)
                self._give_up()
            if reason := self._look():
                get_logger("doormill").fatal(reason)
                self._give_up()

    def _give_up(self) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        if not self._ended.wait(ENDING):
            os._exit(1)
