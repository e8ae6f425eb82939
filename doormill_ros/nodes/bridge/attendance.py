"""Part of /abb_bridge: which nodes of the cell are alive, and whether this bridge is the only one.

A bridge that finds another one in its namespace or at its controller refuses every goal and lets the controller be,
for as long as the other is there; one that was alone before goes on. Of two that began together neither mills. A goal
in a namespace that has two is answered by the one that goes on.
"""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable, Sequence

from doormill_ros.cell.errors import NodeDeadError, NodeDoubledError
from doormill_ros.cell.graph.node_names import ABB_BRIDGE
from doormill_ros.nodes.base.alive import LEASE, AliveWatch, alive_topic
from doormill_ros.nodes.base.managed_node import ManagedNode

#: After so long a bridge that has met no other is the first; discovery takes seconds on a loaded machine [s].
ALONE = 20.0
#: Offered by a bridge that has been alone for so long.
FIRST = f"{ABB_BRIDGE}_first"
#: So long a bridge listens for others before it touches the controller [s].
LISTEN = 0.5
#: After so long without a sign of a first bridge two of one name count as begun together [s]; a goal waits for that.
TIE = 5.0
NAMESPACES = "give each cell a namespace (-r __ns:=/cell1) or a ROS_DOMAIN_ID of its own"


class CellAttendance:
    """Watches the nodes that a run needs, and other bridges.

    Args:
        node: The bridge; make this in its `setup`.
        needed: Names of the nodes that a run needs.
        controller: Names of the controller on this network, see `abb.controller_names`; the first one is shown.
            Bridges that have one of them in common go to the same controller.
        notify: Called after each change.
        lease: Without a sign of life for so long one of the needed nodes is dead [s].
        clock: Monotonic [s].
    """

    def __init__(
        self,
        node: ManagedNode,
        needed: Sequence[str],
        controller: Sequence[str],
        notify: Callable[[], None],
        lease: float = LEASE,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._clock = clock
        self._controller = controller[0]
        self._begun = clock()
        self._node = node
        self._first = False
        claims = [f"/_alive/controller_{zlib.crc32(name.encode()):08x}" for name in controller]
        for claim in claims:
            node.publisher(alive_topic(claim))
        self._lease = lease
        self._nodes = AliveWatch(node, needed, notify, clock)
        # Patience with the living must not keep a restarted node beside its dead predecessor for longer.
        self._patient = (
            self._nodes if lease == LEASE else AliveWatch(node, needed, notify, clock, lease=lease)
        )
        self._bridges = AliveWatch(node, (ABB_BRIDGE, *claims), notify, clock, own=True)
        self._firsts = AliveWatch(node, (FIRST,), notify, clock)

    @property
    def may_touch(self) -> bool:
        """No other bridge is known that may own the controller."""
        listened = self._clock() - self._begun > LISTEN
        return listened and (self._first or not self._bridges.settling())

    @property
    def silent(self) -> bool:
        """Another bridge answers the goals of this namespace."""
        return not self._first and self._firsts.alive(FIRST) and self._bridges.doubled() == ABB_BRIDGE

    @property
    def settled(self) -> bool:
        """See `pipeline.partners.Attendance`."""
        return not (self._nodes.settling() or (self._bridges.settling() and not self._first))

    def require(self, names: Sequence[str]) -> None:
        """See `pipeline.partners.Attendance`."""
        dead = self._patient.dead(names)
        if dead:
            raise NodeDeadError(
                f"/{dead} is dead: it gave no sign of life for {self._lease:g} s; when it runs again, start the "
                "door again"
            )
        doubled = self._nodes.doubled()
        if doubled:
            raise NodeDoubledError(
                f"two nodes /{doubled} are alive in this namespace, and what one cell sees would be taken for "
                f"another's; {NAMESPACES}"
            )
        hindrance = self.hindrance()
        # Refused earlier, the first one's client would take this for its answer.
        if hindrance and (self._bridges.doubled() != ABB_BRIDGE or self.silent or self._bridges.doubled(TIE)):
            raise NodeDoubledError(hindrance)

    def look(self) -> None:
        """Claim to be the first once no other bridge came for long enough; to be called every now and then."""
        alone = not self._bridges.settling() and self._clock() - self._begun > ALONE
        if alone and not self._first:
            self._first = True
            self._node.publisher(alive_topic(FIRST))

    def hindrance(self) -> str:
        """Why this bridge gives way to another one; empty when it does not."""
        other = "" if self._first else self._bridges.doubled()
        if not other:
            return ""
        if other == ABB_BRIDGE:
            return f"another /{ABB_BRIDGE} is alive in this namespace, and this one gives way; {NAMESPACES}"
        return (
            f"another bridge goes to the controller at {self._controller}, and this one gives way; end one of "
            "the two, or set the parameter address"
        )
