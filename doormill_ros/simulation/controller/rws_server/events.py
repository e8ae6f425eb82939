"""Subscriptions: groups of signals and the event streams that report their edges, up and down."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import dataclass, field

from doormill_ros.simulation.controller.rws_server.operations import Form, Operations
from doormill_ros.simulation.controller.rws_server.reply import CODE_BAD_REQUEST, Item, RefusalError, xhtml
from doormill_ros.simulation.controller.rws_server.sessions import Session

_SCAN_PERIOD = 0.003
MAX_RESOURCES = 1000
MAX_HIGH = 64
MAX_GROUPS = 10


@dataclass
class Group:
    """One subscription.

    Attributes:
        number: Its id.
        session: Who subscribed.
        names: Signals by name.
        streams: A queue for each open event stream.
        spent: True once a stream was opened; 2.0 opens none again.
    """

    number: str
    session: Session
    names: list[str]
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
            raise RefusalError(
                400, CODE_BAD_REQUEST, f"{len(resources)} resources, allowed 1 to {MAX_RESOURCES}"
            )
        if sum(g.session is session for g in self.groups.values()) >= MAX_GROUPS:
            raise RefusalError(400, CODE_BAD_REQUEST, f"more than {MAX_GROUPS} groups")
        if sum(form.get(f"{key}-p") == "2" for key in resources) > MAX_HIGH:
            raise RefusalError(400, CODE_BAD_REQUEST, f"more than {MAX_HIGH} resources of high priority")
        names = [self._signal(form.get(key, ""), form.get(f"{key}-p", "")) for key in resources]
        self._count += 1
        group = Group(str(self._count), session, names)
        self.groups[group.number] = group
        return group

    def delete(self, number: str) -> None:
        """End a group and its streams."""
        group = self.groups.pop(number, None)
        if group is None:
            raise RefusalError(404, CODE_BAD_REQUEST, f"no subscription {number}")
        for stream in group.streams:
            stream.put_nowait(None)

    def items(self, group: Group) -> list[Item]:
        """Values of a group now."""
        return [self._event_item(name) for name in group.names]

    async def watch(self) -> None:
        """Look for edges and report them until cancelled."""
        cabinet = self._operations.cabinet
        last = {name: cabinet.value(name) for name in cabinet.signals}
        while True:
            await asyncio.sleep(_SCAN_PERIOD)
            for name in cabinet.signals:
                level = cabinet.value(name)
                if level != last[name]:
                    last[name] = level
                    self._report(name)

    def drop_streams(self) -> None:
        """End every stream, as a broken connection would."""
        for group in self.groups.values():
            for stream in list(group.streams):
                with contextlib.suppress(asyncio.QueueFull):
                    stream.put_nowait(None)

    def _report(self, name: str) -> None:
        for group in self.groups.values():
            if name in group.names:
                links = [(f"subscription/{group.number}", "group")]
                body = xhtml(self._base, [self._event_item(name)], links)
                for stream in group.streams:
                    stream.put_nowait(body)

    def _event_item(self, name: str) -> Item:
        signal = self._operations.cabinet.signals[name]
        return self._operations.signal_item(signal, "ios-signalstate-ev", ";state")

    def _signal(self, resource: str, priority: str) -> str:
        prefix, suffix = "/rw/iosystem/signals/", ";state"
        if priority not in ("0", "1", "2"):
            raise RefusalError(400, CODE_BAD_REQUEST, f"priority {priority!r}, allowed 0, 1 and 2")
        if not (resource.startswith(prefix) and resource.endswith(suffix)):
            raise RefusalError(400, CODE_BAD_REQUEST, f"resource {resource!r} cannot be subscribed to here")
        return self._operations.signal(resource[len(prefix) : -len(suffix)]).name
