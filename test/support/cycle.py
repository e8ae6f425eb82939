"""Insist on the cycle time of appendix A.1."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.toolpath.door_checks import DoorCheck, cycle_budget
from doormill_ros.toolpath.errors import CycleTimeError
from doormill_ros.toolpath.settings import PathSettings


def require_cycle(checks: Sequence[DoorCheck], settings: PathSettings | None = None) -> float:
    """Time of the door: its slowest robot and probing [s].

    Args:
        checks: One of each robot that mills the door at the same time.
        settings: Values of config/toolpath.yaml; None reads the file.

    Raises:
        CycleTimeError: It is longer than appendix A.1 allows.
    """
    whole = cycle_budget(checks, settings)
    if not whole.kept:
        slow = max((f for check in checks for f in check.features), key=lambda f: f.time)
        raise CycleTimeError(
            f"{slow.feature}: it takes {slow.time:.1f} s, which makes the door {whole.found:.1f} s with "
            f"probing, allowed are {whole.allowed:.1f} s; raise its feed or depth step, "
            "or split the door between two robots",
            feature=slow.feature,
            found=whole.found,
            allowed=whole.allowed,
        )
    return whole.found
