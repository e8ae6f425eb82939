"""Who offers or asks for a topic of a node and gets nothing of it: another quality of service, or another type.

rclpy would tell of it by two events an endpoint, and looks at every event each time anything wakes the node: on a
node with fifty endpoints that takes longer than the message that woke it. Here the graph is asked now and then.
"""

from __future__ import annotations

from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

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
        sentences = []
        for subscription in list(node.subscriptions):
            topic = subscription.topic_name
            for other in node.get_publishers_info_by_topic(topic):
                why = _mismatch(subscription, other, other.qos_profile, subscription.qos_profile)
                if why:
                    sentences.append(
                        f"{_named(other)} publishes {topic}, and nothing of it arrives here: {why}; correct the offer"
                    )
        for publisher in list(node.publishers):
            topic = publisher.topic_name
            for other in node.get_subscriptions_info_by_topic(topic):
                why = _mismatch(publisher, other, publisher.qos_profile, other.qos_profile)
                if why:
                    sentences.append(
                        f"{_named(other)} subscribes to {topic}, and nothing from here arrives there: {why}; correct "
                        "the request"
                    )
        return sentences


def _mismatch(own: Any, other: Any, offered: Any, requested: Any) -> str:
    if other.node_name == _UNKNOWN:  # it has just come; the next look finds its name
        return ""
    kind = own.msg_type.__module__.split(".")[0] + "/msg/" + own.msg_type.__name__
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
