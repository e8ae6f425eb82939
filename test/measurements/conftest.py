"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.arms import arm, write_arm_sets  # noqa: F401
from support.loading_sets import kinematics, make_set, robot  # noqa: F401
from support.pose_sets import faults, invented, write_pose_sets  # noqa: F401
