"""Subscriptions: groups of resources and the event streams that report their changes, up and down."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.rws_server.operations import Form, Operations
from doormill_ros.simulation.controller.rws_server.reply import CODE_INVALID, Item, RefusalError, xhtml
from doormill_ros.simulation.controller.rws_server.sessions import Session

_SCAN_PERIOD = 0.003
MAX_RESOURCES = 1000
MAX_HIGH = 64
MAX_GROUPS = 10
_SIGNAL = re.compile("/rw/iosystem/signals/(.+);state")
_SYMBOL = re.compile("/rw/rapid/symbol/(?:data/)?RAPID/(.+?)(?:/data)?;value")
_STATE = re.compile("/rw/panel/(ctrl-?state|opmode|speedratio)(?:;[a-z-]+)?")
_EXECUTION = re.compile("/rw/rapid/execution;ctrlexecstate")
_LOG = re.compile("/rw/elog/0")
_QUEUE = re.compile("/rw/dipc/([^/;]+)")


@dataclass
class Resource:
    """One thing that a group watches.

    Attributes:
        mark: Changes when there is something to report.
        event: What to report, given the mark before.
        last: The mark when it was looked at last.
    """

    mark: Callable[[], object]
    event: Callable[[object], list[Item]]
    last: object = None


@dataclass
class Group:
    """One subscription.

    Attributes:
        number: Its id.
        session: Who subscribed.
        resources: What it watches.
        streams: A queue for each open event stream.
        spent: True once a stream was opened; 2.0 opens none again.
    """

    number: str
    session: Session
    resources: list[Resource]
    streams: set[asyncio.Queue[bytes | None]] = field(default_factory=set)
    spent: bool = False


class Subscriptions:
    """All groups of one server; lives in its event loop."""

    def __init__(self, operations: Operations, base: str) -> None:
        self._operations = operations
        self._base = base
        self._count = 0
        self.groups: dict[str, Group] = {}

    def create(self, session: Session, form: Form, resources: list[str]) -> Group:
        """Make a group from a subscription's body.

        Raises:
            RefusalError: Nothing, too much or something unknown is asked for.
        """
        if not 1 <= len(resources) <= MAX_RESOURCES:
            raise RefusalError(400, CODE_INVALID, f"{len(resources)} resources, allowed 1 to {MAX_RESOURCES}")
        if sum(g.session is session for g in self.groups.values()) >= MAX_GROUPS:
            raise RefusalError(400, CODE_INVALID, f"more than {MAX_GROUPS} groups")
        if sum(form.get(f"{key}-p") == "2" for key in resources) > MAX_HIGH:
            raise RefusalError(400, CODE_INVALID, f"more than {MAX_HIGH} resources of high priority")
        watched = [self._resource(form.get(key, ""), form.get(f"{key}-p", "")) for key in resources]
        for resource in watched:
            resource.last = resource.mark()
        self._count += 1
        group = Group(str(self._count), session, watched)
        self.groups[group.number] = group
        return group

    def delete(self, number: str) -> None:
        """End a group and its streams."""
        group = self.groups.pop(number, None)
        if group is None:
            raise RefusalError(404, CODE_INVALID, f"no subscription {number}")
        for stream in group.streams:
            stream.put_nowait(None)

    def items(self, group: Group) -> list[Item]:
        """Values of a group now."""
        return [item for resource in group.resources for item in resource.event(resource.last)]

    async def watch(self) -> None:
        """Look for changes and report them until cancelled."""
        while True:
            await asyncio.sleep(_SCAN_PERIOD)
            for group in list(self.groups.values()):
                for resource in group.resources:
                    # What went away meanwhile has no changes.
                    with contextlib.suppress(RefusalError, AbbError):
                        self._look(group, resource)

    def drop_streams(self) -> None:
        """End every stream, as a broken connection would."""
        for group in self.groups.values():
            for stream in list(group.streams):
                with contextlib.suppress(asyncio.QueueFull):
                    stream.put_nowait(None)

    def _look(self, group: Group, resource: Resource) -> None:
        mark = resource.mark()
        if mark != resource.last:
            before, resource.last = resource.last, mark
            self._report(group, resource.event(before))

    def _report(self, group: Group, items: list[Item]) -> None:
        for item in items:
            body = xhtml(self._base, [item], [(f"subscription/{group.number}", "group")])
            for stream in group.streams:
                stream.put_nowait(body)

    def _resource(self, address: str, priority: str) -> Resource:
        operations = self._operations
        if priority not in ("0", "1", "2"):
            raise RefusalError(400, CODE_INVALID, f"priority {priority!r}, allowed 0, 1 and 2")
        high = priority == "2"
        if match := _SIGNAL.fullmatch(address):
            signal = operations.signal(match[1])
            return Resource(
                lambda: operations.cabinet.value(signal.name),
                lambda _: [operations.signal_item(signal, "ios-signalstate-ev", ";state")],
            )
        if match := _SYMBOL.fullmatch(address):
            path = match[1]
            return Resource(
                lambda: operations.symbol(path).values["value"],
                lambda _: [operations.symbol(path, event=True)],
            )
        if high:
            raise RefusalError(400, CODE_INVALID, "high priority is for signals and persistents alone")
        if match := _STATE.fullmatch(address):
            what = match[1].replace("-", "")
            return Resource(
                lambda: operations.panel(what).values, lambda _: [operations.panel(what, event=True)]
            )
        if _EXECUTION.fullmatch(address):
            return Resource(
                lambda: operations.execution().values["ctrlexecstate"],
                lambda _: [operations.execution(event=True)],
            )
        if _LOG.fullmatch(address):
            return Resource(lambda: len(operations.cabinet.controller.event_log()), self._log_events)
        if match := _QUEUE.fullmatch(address):
            queue = operations.queues.find(match[1])
            return Resource(lambda: queue.count, lambda _: [_as_event(queue.last)] if queue.last else [])
        raise RefusalError(400, CODE_INVALID, f"resource {address!r} cannot be subscribed to here")

    def _log_events(self, before: object) -> list[Item]:
        entries = self._operations.cabinet.controller.event_log()
        first = before if isinstance(before, int) else 0
        return [
            Item("elog-message-ev", str(e.number), f"/rw/elog/0/{e.number}", {"seqnum": str(e.number)})
            for e in entries[first:]
        ]


def _as_event(message: Item) -> Item:
    return Item("dipc-msg-ev", message.title, message.href, message.values)
