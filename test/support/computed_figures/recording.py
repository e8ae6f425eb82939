"""What docs/recording.md prints: how closely a replay must agree."""

from __future__ import annotations

import re

from doormill_ros.recording.replay.offline import LAST_REPLAYED
from doormill_ros.recording.replay.tolerance import tolerance_of
from support.source_tree import ROOT

FIRST_NOT_REPLAYED = LAST_REPLAYED + 1
POSE, ANGLE = tolerance_of("pose.pose.position"), tolerance_of("pose.pose.orientation")
COVARIANCE, RESIDUAL = tolerance_of("pose.covariance[0]"), tolerance_of("residual")
CORRELATION = tolerance_of("pose.correlation[0]")
TARGET, JOINTS = tolerance_of("targets[0].position"), tolerance_of("targets[0].joint_positions")
BENT, TURNED = tolerance_of("deflection.linear"), tolerance_of("deflection.angular")
FORCE, TORQUE = tolerance_of("wrench.force"), tolerance_of("wrench.torque")


def exposures_meant() -> float:
    """Pictures whose mean has as little noise as those of the reference bags."""
    (share,) = re.findall(r"noise: (0\.\d+)", (ROOT / "bags" / "timeline.yaml").read_text(encoding="utf-8"))
    return 1.0 / float(share) ** 2
