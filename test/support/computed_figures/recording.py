"""What docs/recording.md prints: how closely a replay must agree."""

from __future__ import annotations

from doormill_ros.recording.replay.tolerance import tolerance_of

POSE, ANGLE = tolerance_of("pose.pose.position"), tolerance_of("pose.pose.orientation")
COVARIANCE, RESIDUAL = tolerance_of("pose.covariance[0]"), tolerance_of("residual")
TARGET, JOINTS = tolerance_of("targets[0].position"), tolerance_of("targets[0].joint_positions")
BENT, TURNED = tolerance_of("deflection.linear"), tolerance_of("deflection.angular")
FORCE, TORQUE = tolerance_of("wrench.force"), tolerance_of("wrench.torque")
