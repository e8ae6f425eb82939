"""One spindle, one tool: refuse work for which the tool would have to be changed on the way."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.toolpath.errors import ToolChangeError
from doormill_ros.toolpath.operation import Operation
from doormill_ros.toolpath.settings import Checks


def check_tools(operations: Sequence[Operation], checks: Checks) -> None:
    """Refuse a robot's share of a door that takes more tools than its spindle holds.

    Neither the target file nor the RAPID module has a tool change, and the tool centre point is
    that of one tool: a feature milled with the tool of another would come out too wide or too narrow.

    Args:
        operations: What one robot mills, in order.
        checks: How many tools it has.

    Raises:
        ToolChangeError: They are too few.
    """
    first: dict[str, str] = {}
    for item in operations:
        first.setdefault(item.feature.tool.name, item.feature.id)
    allowed = checks.tools
    if len(first) > allowed:
        feature = list(first.values())[allowed]
        found = ", ".join(f"{tool} for {name}" for tool, name in first.items())
        raise ToolChangeError(
            f"{feature}: the door takes {len(first)} tools ({found}), allowed are {allowed}, since the robot "
            "cannot change them; give the features one tool, or split the door between two robots",
            feature=feature,
            found=len(first),
            allowed=allowed,
        )
