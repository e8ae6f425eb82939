"""Message queues (DIPC): a client makes one, and messages sent to it wait until they are read."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    CODE_NO_RESOURCE,
    Item,
    RefusalError,
)


@dataclass
class Queue:
    """Messages in a queue, and how many ever came."""

    messages: deque[Item] = field(default_factory=deque)
    count: int = 0
    last: Item | None = None


class Queues:
    """All queues; a RAPID task has one only with a program that takes messages, and ours takes none."""

    def __init__(self) -> None:
        self.queues: dict[str, Queue] = {}

    def create(self, form: dict[str, str]) -> None:
        """Make a queue."""
        name = form.get("dipc-queue-name", "")
        if not name or name in self.queues:
            raise RefusalError(400, CODE_INVALID, f"queue {name!r} is missing its name or exists already")
        self.queues[name] = Queue()

    def send(self, name: str, form: dict[str, str]) -> None:
        """Put a message into a queue."""
        queue = self.find(name)
        source = form.get("dipc-src-queue-name", "")
        self.find(source)
        message = {
            key: form.get(key, "") for key in ("dipc-cmd", "dipc-userdef", "dipc-msgtype", "dipc-data")
        }
        queue.last = Item("dipc-read-li", name, f"/rw/dipc/{name}", {**message, "queue-name": source})
        queue.count += 1
        queue.messages.append(queue.last)

    def read(self, name: str) -> list[Item]:
        """Take all messages out of a queue."""
        queue = self.find(name)
        found = list(queue.messages)
        queue.messages.clear()
        return found

    def delete(self, name: str) -> None:
        """Remove a queue."""
        self.find(name)
        del self.queues[name]

    def find(self, name: str) -> Queue:
        """A queue by its name."""
        if name not in self.queues:
            raise RefusalError(404, CODE_NO_RESOURCE, f"queue {name} does not exist")
        return self.queues[name]
