"""Take pictures from a camera's topic, for tools that run for a while and end."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.exceptions import InvalidTopicNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CompressedImage, Image

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.errors import BadPicture
from doormill_ros.messages.picture import picture_of

PERIOD = 0.1  # s
#: Only the newest picture is looked at; any camera's reliability will do.
NEWEST = QoSProfile(depth=1, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT)


def listen(topic: str, take: Callable[[ByteArray], bool], limit: float) -> bool:
    """Hand pictures to `take` until it says that they are enough; whether it did before the limit [s] was over.

    Args:
        topic: Of sensor_msgs/Image, or of sensor_msgs/CompressedImage when its name ends with "/compressed".
        take: Gets a grey picture, shape (h, w), uint8.
        limit: Longest time; an interrupt ends it as well.

    Raises:
        BadPicture: A picture is of a kind that is not read, none came at all, or no topic can have that name.
    """
    waiting: list[Any] = []
    rclpy.init(args=["calibrate"])
    node = Node("calibrate", enable_rosout=False, start_parameter_services=False)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    kind = CompressedImage if topic.endswith("/compressed") else Image
    some = False
    try:
        node.create_subscription(
            kind, topic, lambda message: waiting.__setitem__(slice(None), [message]), NEWEST
        )
        end = time.monotonic() + limit
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=PERIOD)
            if waiting:
                some = True
                if take(picture_of(waiting.pop())):
                    return True
    except InvalidTopicNameException as error:
        raise BadPicture(
            f"{topic!r} is no name of a topic, allowed are letters, digits, _ and /; give one such as camera/image_raw"
        ) from error
    except KeyboardInterrupt:
        return False
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
    if not some:
        raise BadPicture(
            f"no picture came on {topic} within {limit:g} s; start the camera, or name its topic"
        )
    return False
