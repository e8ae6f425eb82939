"""What requirements/ asks for, and what Python files import."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

from packaging.requirements import Requirement

from support.source_tree import ROOT, imports_of

#: Modules of this repository.
OWN = {
    "doormill_ros",
    "support",
    "bags",
    "bench",
    "scripts",
    *(path.stem for path in (ROOT / "bench").glob("*.py")),
}
#: Distributions by module, where the module may not be installed here.
_DISTRIBUTIONS = {"pinocchio": "pin", "coal": "pin", "hppfcl": "pin", "eaik": "eaik", "atheris": "atheris"}
_ROS = {"rclpy", "launch", "launch_ros", "ament_index_python"}
_ROS_ENDS = ("_msgs", "_interfaces", "_srvs")


def required(name: str) -> dict[str, Requirement]:
    """Requirements of requirements/<name>.txt by lower-case name."""
    lines = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    found = [Requirement(line) for line in lines if line and not line.startswith(("#", "-r"))]
    return {_plain(requirement.name): requirement for requirement in found}


def imported(paths: Iterable[Path]) -> tuple[set[str], list[set[str]]]:
    """What files import from outside the repository and Python.

    Returns:
        ROS packages, and the names of the distributions that may bring each other module.
    """
    modules = {module.split(".")[0] for path in paths for module in imports_of(path)}
    modules -= {*OWN, *sys.stdlib_module_names} - {"doormill_interfaces"}
    ros = {name for name in modules if name in _ROS or name.endswith(_ROS_ENDS)}
    others = [
        {_plain(name) for name in _installed().get(module, [_DISTRIBUTIONS.get(module, module)])}
        for module in sorted(modules - ros)
    ]
    return ros, others


@cache
def _installed() -> Mapping[str, list[str]]:
    """Distributions by module; looking takes seconds."""
    return packages_distributions()


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
