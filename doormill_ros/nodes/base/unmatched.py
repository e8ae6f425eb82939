"""Who offers or asks for a topic of a node and gets nothing of it: another quality of service, or another type.

rclpy would tell of it by two events an endpoint, and looks at every event each time anything wakes the node: on a
node with fifty endpoints that takes longer than the message that woke it. Here the graph is asked now and then.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

from doormill_ros.nodes.base.found_topics import type_name

PERIOD = 10.0  # s
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
#: For endpoints whose events nobody asks for.
NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)


class UnmatchedEndpoints:
    """Asks the graph about a node's topics, and tells of each other node once.

    Args:
        node: Any node of rclpy.
    """

    def __init__(self, node: Any) -> None:
        self._node = node
        self._told: set[str] = set()

    def news(self) -> list[str]:
        """A sentence on each endpoint that was not told of before."""
        found = [sentence for sentence in self._sentences() if sentence not in self._told]
        self._told.update(found)
        return found

    def _sentences(self) -> list[str]:
        node = self._node
        # Of what is asked for twice, by a lesser quality where no better one is offered, one has to fit.
        offers: dict[tuple[str, bytes], list[str]] = {}
        for subscription in list(node.subscriptions):
            for topic, other in self._others(subscription, node.get_publishers_info_by_topic):
                why = _mismatch(subscription, other, other.qos_profile, subscription.qos_profile)
                told = f"{_named(other)} publishes {topic}, and nothing of it arrives here: {why}; correct the offer"
                offers.setdefault((topic, bytes(other.endpoint_gid)), []).append(why and told)
        sentences = [told[0] for told in offers.values() if all(told)]
        for publisher in list(node.publishers):
            for topic, other in self._others(publisher, node.get_subscriptions_info_by_topic):
                why = _mismatch(publisher, other, publisher.qos_profile, other.qos_profile)
                if why:
                    told_of = f"{_named(other)} subscribes to {topic}, and nothing from here arrives there"
                    sentences.append(f"{told_of}: {why}; correct the request")
        return sentences

    @staticmethod
    def _others(own: Any, ask: Callable[[str], list[Any]]) -> list[tuple[str, Any]]:
        """Topic and endpoints on the other side of an own one; none where that is destroyed meanwhile."""
        try:
            topic = own.topic_name
            return [(topic, other) for other in ask(topic)]
        except rclpy_implementation.InvalidHandle:
            return []


def _mismatch(own: Any, other: Any, offered: Any, requested: Any) -> str:
    if other.node_name == _UNKNOWN:  # it has just come; the next look finds its name
        return ""
    kind = type_name(own.msg_type)
    if other.topic_type != kind:
        return f"its type is {other.topic_type}, this one has {kind}"
    # Of deadlines and leases the graph tells the largest number where an endpoint has none.
    compatibility, reason = qos_check_compatible(
        *(
            QoSProfile(depth=1, reliability=p.reliability, durability=p.durability)
            for p in (offered, requested)
        )
    )
    if compatibility != QoSCompatibility.ERROR:
        return ""
    return ", ".join(part.removeprefix("ERROR: ").strip() for part in str(reason).split(";") if part.strip())


def _named(other: Any) -> str:
    return f"{other.node_namespace.rstrip('/')}/{other.node_name}"
