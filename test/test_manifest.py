"""package.xml, setup.py and the source agree."""

from __future__ import annotations

import ast
import importlib
import re
import runpy
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest
import yaml

from doormill_ros import __version__
from support.requirements import imported, required
from support.source_tree import DATA, PACKAGE, ROOT, SOURCES
from support.waiting import LIMIT

PACKAGES = (".", "doormill_interfaces")
KEYS: dict[str, Any] = yaml.safe_load((DATA / "rosdep_keys.yaml").read_text(encoding="utf-8"))


def manifest(folder: str = ".") -> ElementTree.Element:
    return ElementTree.parse(ROOT / folder / "package.xml").getroot()


def dependencies(*tags: str, folder: str = ".") -> set[str]:
    return {e.text for e in manifest(folder) if e.tag in tags}


def system(keys: set[str]) -> set[str]:
    """Keys of the operating system's packages; the others are ROS packages."""
    return {key for key in keys if key.startswith("python3-")}


def ros_packages() -> set[str]:
    """ROS packages that the source or a launch file imports."""
    return imported([*SOURCES, *sorted((ROOT / "launch").glob("*.py"))])[0]


def test_package_xml_names_every_imported_ros_package() -> None:
    assert ros_packages() >= {"rclpy", "doormill_interfaces", "launch_ros", "sensor_msgs"}
    assert ros_packages() - dependencies("depend", "exec_depend") == set()


def test_package_xml_names_nothing_that_is_not_imported() -> None:
    named = dependencies("depend", "exec_depend")
    assert named - system(named) - ros_packages() == set()


def test_package_xml_names_what_only_tests_import() -> None:
    assert imported((ROOT / "test").rglob("*.py"))[0] - ros_packages() == dependencies("test_depend")


@pytest.mark.parametrize("folder", PACKAGES)
def test_rosdep_knows_every_key(folder: str) -> None:
    named = {e.text for e in manifest(folder) if e.tag.endswith("depend")}
    assert len(named) >= 5
    own = {manifest(package).findtext("name") for package in PACKAGES}
    assert named - own - {*KEYS["packages"], *KEYS["system"]} == set()


def test_package_xml_names_the_keys_that_bring_a_version_new_enough() -> None:
    """What they would bring too old, pip brings; so it does what has no key."""
    enough = {
        key
        for key, entry in KEYS["system"].items()
        if entry["noble"] and entry["noble"] in required("run")[entry["requirement"]].specifier
    }
    assert len(enough) >= 3
    assert system(dependencies("exec_depend")) == enough


def test_versions_agree() -> None:
    versions = {
        manifest().findtext("version"),
        manifest("doormill_interfaces").findtext("version"),
        __version__,
    }
    setup = re.search(r'version="([^"]+)"', (ROOT / "setup.py").read_text(encoding="utf-8"))[1]
    assert versions == {setup}


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
    assert len(entry_points()) == 26
    for name, module in entry_points().items():
        assert callable(importlib.import_module(module).main), name


def test_bags_are_installed_without_the_scripts_that_make_them(monkeypatch: pytest.MonkeyPatch) -> None:
    told: dict[str, Any] = {}
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr("setuptools.setup", told.update)
    runpy.run_path("setup.py")
    installed = {name for _, names in told["data_files"] for name in names}
    assert {"bags/standard_door/metadata.yaml", "config/cell.yaml", "launch/cell.launch.py"} <= installed
    assert {name for name in installed if Path(name).parts[0] == "bags" and name.endswith(".py")} == set()


def test_every_file_of_the_package_is_installed_with_it(tmp_path: Path) -> None:
    """Templates, grammars, styles, scripts and the mark that there are types."""
    subprocess.run(
        [sys.executable, "setup.py", "-q", "build_py", "--build-lib", tmp_path],
        cwd=ROOT,
        check=True,
        timeout=LIMIT,
    )

    def files(package: Path) -> set[str]:
        names = {path.relative_to(package) for path in package.rglob("*") if path.is_file()}
        return {str(name) for name in names if "__pycache__" not in name.parts}

    built = files(tmp_path / PACKAGE.name)
    assert "py.typed" in built
    assert {Path(name).suffix for name in built} >= {".lark", ".j2", ".html", ".css", ".js", ".svg"}
    assert built == files(PACKAGE)
