"""How a run ended."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from doormill_interfaces.msg import StageTimes
from doormill_ros.pipeline.run_end import RunEnd


def run_end_into(end: RunEnd, message_type: Any) -> Any:
    """A result of mill_door or a RunResult, by the names of its fields."""
    values = {
        **asdict(end),
        "times": StageTimes(**asdict(end.times)),
        "measured": end.inspection.measured,
        "worst_feature": end.inspection.feature,
        "deviation": end.inspection.deviation,
        "tolerance": end.inspection.tolerance,
    }
    names = message_type.get_fields_and_field_types()
    return message_type(**{name: values[name] for name in names if name in values})
