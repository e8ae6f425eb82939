"""What a worker does with one thing: ask the function, and make whatever comes of it bytes again."""

from __future__ import annotations

import functools
import pickle
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from distributed import get_worker

from doormill_ros.configuration import configuration
from doormill_ros.errors import DoormillError, one_line
from doormill_ros.parallel.errors import OtherSoftwareError
from doormill_ros.software import software


@dataclass(frozen=True)
class Reply:
    """What a worker says of one thing.

    Attributes:
        value: What the function returned; None where it raised.
        error_code: Of what it raised; 0 where it returned.
        reason: That error's sentence.
        seconds: Processor time that it took [s].
        worker: Address of the worker.
    """

    value: Any = None
    error_code: int = 0
    reason: str = ""
    seconds: float = 0.0
    worker: str = ""


def asking() -> tuple[str, str]:
    """Software and configuration of this process as they travel."""
    return software(), configuration()


#: Of a worker as it was first asked for: what it has read since it holds on to.
_own = functools.cache(configuration)


def pack(ask: Callable[[Any], Any], thing: Any, here: tuple[str, str]) -> tuple[tuple[str, str], str, bytes]:
    """A question as it travels: what `asking` told, the thing's name, and the rest as bytes."""
    return here, str(thing), pickle.dumps((ask, thing))


def answer(question: tuple[tuple[str, str], str, bytes]) -> bytes:
    """One answer, whatever the function does; runs in the worker."""
    (wanted, configured), name, content = question
    worker, begun = get_worker().address, time.process_time()
    value, code, reason = None, 0, ""
    try:
        if software() != wanted:
            raise OtherSoftwareError(
                f"worker {worker} runs {software()}, asked by {wanted}; update it and start it again"
            )
        if _own() != configured:
            raise OtherSoftwareError(
                f"worker {worker} has another configuration ({_own()}) than who asks ({configured}); give its site the "
                "same files in config/ and start it again"
            )
        ask, thing = pickle.loads(content)
        value = ask(thing)
        pickle.dumps(value)
    except DoormillError as error:
        value, code, reason = None, error.code, error.message
    except (Exception, SystemExit) as error:
        value, code, reason = None, DoormillError.code, one_line(f"{name}: {type(error).__name__}: {error}")
    return pickle.dumps(Reply(value, code, reason, time.process_time() - begun, worker))
