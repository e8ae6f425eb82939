"""Mill hinges, lock cases and handle holes into doors with an ABB robot, as a ROS 2 node graph."""

__version__ = "0.1.0"
