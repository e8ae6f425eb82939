"""package.xml, setup.py and the source agree."""

from __future__ import annotations

import ast
import importlib
import re
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import packages_distributions

from doormill_ros import __version__
from support.source_tree import ROOT, SOURCES, imports_of

OWN = {"doormill_ros", "test", "harness"}
WITHOUT_DISTRIBUTION = {"pinocchio": "pin"}


def manifest(folder: str = ".") -> ElementTree.Element:
    return ElementTree.parse(ROOT / folder / "package.xml").getroot()


def dependencies() -> set[str]:
    return {e.text for e in manifest() if e.tag in ("depend", "exec_depend")}


def ros_packages() -> set[str]:
    """ROS packages that the source or a launch file imports."""
    found = set()
    for path in [*SOURCES, *sorted((ROOT / "launch").glob("*.py"))]:
        for module in imports_of(path):
            top = module.split(".")[0]
            if top in {"rclpy", "launch", "launch_ros", "ament_index_python"} or top.endswith(
                ("_msgs", "_interfaces", "_srvs")
            ):
                found.add(top)
    return found


def test_package_xml_names_every_imported_ros_package() -> None:
    assert ros_packages() >= {"rclpy", "doormill_interfaces", "launch_ros", "sensor_msgs"}
    assert ros_packages() - dependencies() == set()


def test_package_xml_names_nothing_that_is_not_imported() -> None:
    assert dependencies() - ros_packages() == set()


def test_versions_agree() -> None:
    versions = {
        manifest().findtext("version"),
        manifest("doormill_interfaces").findtext("version"),
        __version__,
    }
    setup = re.search(r'version="([^"]+)"', (ROOT / "setup.py").read_text(encoding="utf-8"))[1]
    assert versions == {setup}


def requirements() -> set[str]:
    names = set()
    for line in (ROOT / "requirements" / "run.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            assert ">=" in line, f"{line} has no lower bound"
            names.add(re.split(r"[\[>]", line)[0].lower())
    return names


def test_every_imported_python_package_is_required() -> None:
    installed, ros, required = packages_distributions(), ros_packages(), requirements()
    missing = set()
    for path in SOURCES:
        for module in imports_of(path):
            top = module.split(".")[0]
            if top in OWN or top in sys.stdlib_module_names or top in ros:
                continue
            names = {n.lower() for n in installed.get(top, [WITHOUT_DISTRIBUTION.get(top, top)])}
            if not names & required:
                missing.add(top)
    assert missing <= {"builtin_interfaces"}


def test_the_readme_says_why_each_requirement_is_there() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8").lower()
    assert {name for name in requirements() if f"`{name}`" not in text} == set()


def entry_points() -> dict[str, str]:
    tree = ast.parse((ROOT / "setup.py").read_text(encoding="utf-8"))
    names = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and node.targets[0].id in ("NODES", "TOOLS"):
            folder = node.targets[0].id.lower()
            for item in node.value.elts:
                names[item.value] = f"doormill_ros.{folder}.{item.value}"
    return names


def test_every_executable_has_a_main() -> None:
    assert len(entry_points()) == 15
    for name, module in entry_points().items():
        assert callable(importlib.import_module(module).main), name
