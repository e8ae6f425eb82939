"""Ask one function about many things and hand out the answers as they come.

Queues, retries and data between machines are Dask's. A worker that is lost costs its work, which another one does
again; what no worker survives is named as an answer of its own.
"""

from __future__ import annotations

import pickle
from asyncio import CancelledError
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from distributed import Client, Future, KilledWorker, as_completed
from distributed.client import FutureCancelledError

from doormill_ros.errors import one_line
from doormill_ros.parallel.answer import Reply, asking, pack
from doormill_ros.parallel.errors import NoSchedulerError, OtherSoftwareError, WorkersDiedError
from doormill_ros.parallel.workplace import Workplace

Thing = TypeVar("Thing")
Value = TypeVar("Value")


@dataclass(frozen=True)
class Answered(Generic[Thing, Value]):
    """What came of one thing.

    Attributes:
        thing: Which.
        value: What the function returned; None where it raised.
        error_code: Of what it raised; 0 where it returned.
        reason: That error's sentence.
        seconds: Processor time that it took [s]; 0 where the worker died of it.
        worker: Address of the worker.
    """

    thing: Thing
    value: Value | None = None
    error_code: int = 0
    reason: str = ""
    seconds: float = 0.0
    worker: str = ""


def each(
    ask: Callable[[Thing], Value], things: Sequence[Thing], place: Workplace
) -> Iterator[Answered[Thing, Value]]:
    """Answers in the order in which they come, one for each thing.

    Args:
        ask: Called with each thing in some process; a function of a module, what it returns can be pickled.
        things: Can be pickled; named in the answers.
        place: Where.

    Raises:
        NoSchedulerError: The scheduler cannot be reached or went away.
        NoWorkerError: It has no worker.
    """
    if not things:
        return
    with place.client() as client:
        yield from _answers(client, ask, things)


def _answers(
    client: Client, ask: Callable[[Thing], Value], things: Sequence[Thing]
) -> Iterator[Answered[Thing, Value]]:
    messenger, here = _messenger(), asking()
    suspects: list[Thing] = []
    # Equal things are asked each for itself.
    futures = client.map(messenger, [pack(ask, thing, here) for thing in things], pure=False)
    waiting = {future.key: thing for future, thing in zip(futures, things, strict=True)}
    completed = as_completed(futures)
    del futures  # what was answered is let go on the workers
    for future in completed:
        thing = waiting.pop(future.key)
        answered = _answered(thing, future, len(waiting) + len(suspects))
        if answered.error_code == WorkersDiedError.code:
            suspects.append(thing)
        else:
            yield answered
    # Whatever waited on a worker when it died is suspected along with what killed it: now each one alone.
    for left, thing in enumerate(reversed(suspects)):
        future = client.submit(messenger, pack(ask, thing, here), pure=False)
        yield _answered(thing, future, len(suspects) - left - 1)


def _answered(thing: Thing, future: Future, left: int) -> Answered[Thing, Any]:
    """The answer that a future holds or will hold; `left` others are missing."""
    try:
        reply = future.result()
    except KilledWorker as error:
        sentence = f"{thing}: {error.allowed_failures + 1} workers died of it; look at what it holds"
        return Answered(
            thing, None, WorkersDiedError.code, one_line(sentence), 0.0, error.last_worker.address
        )
    except (FutureCancelledError, CancelledError, OSError) as error:
        raise NoSchedulerError(
            f"the scheduler went away, {left + 1} of the answers are missing: {error}; ask again when it is back"
        ) from error
    return Answered(thing, **vars(_read(reply)))


def _read(reply: Any) -> Reply:
    if isinstance(reply, bytes):
        found: Reply = pickle.loads(reply)
        return found
    worker, problem = reply
    sentence = f"worker {worker} lacks this software: {problem}; start it in an environment that has it"
    return Reply(None, OtherSoftwareError.code, one_line(sentence), 0.0, worker)


def _messenger() -> Callable[[Any], Any]:
    """What workers are sent: a function without a name travels whole, and what it carries is bytes.

    One with a name, or things of our types, would be imported while the worker reads its orders; where that fails the
    library drops the connection and tries for ever.
    """

    def deliver(question: Any) -> Any:
        try:
            from doormill_ros.parallel.answer import answer
        except Exception as error:
            from distributed import get_worker

            return get_worker().address, str(error)
        return answer(question)

    return deliver
