"""Who keeps the results of runs gets each of them, however long it did not look."""

from __future__ import annotations

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from doormill_interfaces.msg import RunResult
from doormill_ros.nodes.base import topics


def test_results_that_follow_each_other_at_once_are_all_heard(context: rclpy.Context) -> None:
    topic, heard = topics.RUN_RESULT, []
    node = Node("history", context=context)
    node.create_subscription(
        topic.type, topic.name, lambda result: heard.append(result.run_id), topic.requested
    )
    publisher = node.create_publisher(topic.type, topic.name, topic.offered)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    while publisher.get_subscription_count() == 0:
        executor.spin_once(0.05)
    for run in ("1", "2", "3"):
        publisher.publish(RunResult(run_id=run))
        assert publisher.wait_for_all_acked(Duration(seconds=600))
    for _ in range(20):
        executor.spin_once(0.05)
    assert heard == ["1", "2", "3"]
    executor.shutdown()
    node.destroy_node()
