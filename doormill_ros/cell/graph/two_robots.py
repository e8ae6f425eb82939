"""What the two robots are called that share a door, and where their topics are."""

from __future__ import annotations

FIRST, SECOND = "first", "second"
#: Namespaces of the two below the cell's, with the shares that they mill.
SHARE_OF = {"robot1": FIRST, "robot2": SECOND}


def in_robot(name: str) -> str:
    """Namespace of a robot's nodes below the cell's: robot1 or robot2."""
    return next(place for place, share in SHARE_OF.items() if share == name)


def robot_of(topic: str) -> str:
    """Namespace of the robot whose topic it is; empty for one of the cell's."""
    return next((name for name in topic.split("/")[:-2] if name in SHARE_OF), "")
