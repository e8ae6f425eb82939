"""No node of ours hides what rclpy's own node keeps under the same name."""

import ast
import inspect
import textwrap

import rclpy
from rclpy.lifecycle import LifecycleNode

from support.package_nodes import nodes_of_the_package


def assigned(kind):
    """Attributes of itself that a class sets in its own lines."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind)))
    return {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    }


def test_no_attribute_hides_one_of_rclpy():
    context = rclpy.Context()
    rclpy.init(context=context)
    try:
        plain = LifecycleNode("plain", context=context)
        theirs = set(vars(plain))
        plain.destroy_node()
    finally:
        rclpy.shutdown(context=context)
    assert {"_clock", "_timers", "_parameters"} <= theirs
    nodes = nodes_of_the_package()
    assert len(nodes) > 8
    hidden = {kind.__name__: sorted(assigned(kind) & theirs) for kind in nodes}
    assert {name: names for name, names in hidden.items() if names} == {}
