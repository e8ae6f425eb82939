"""Both packages are found and built from the root of a workspace, beside another package, as the README says."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from catkin_pkg.packages import find_packages

from support.source_tree import ROOT
from support.waiting import LIMIT

SECTION = (ROOT / "README.md").read_text(encoding="utf-8").split("## In a workspace")[1].split("\n## ")[0]
(BUILD,) = re.findall(r"^python -m colcon build .*$", SECTION, re.MULTILINE)
(ROSDEP,) = re.findall(r"^rosdep install .*$", SECTION, re.MULTILINE)
PACKAGES = {"doormill_interfaces", "doormill_ros", "neighbour"}
NEIGHBOUR = {
    "package.xml": """<?xml version="1.0"?>
<package format="3">
  <name>neighbour</name>
  <version>0.0.1</version>
  <description>Needs the interfaces.</description>
  <maintainer email="neighbour@example.org">neighbour</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <depend>doormill_interfaces</depend>
  <export><build_type>ament_cmake</build_type></export>
</package>
""",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.20)
project(neighbour NONE)
find_package(ament_cmake REQUIRED)
find_package(doormill_interfaces REQUIRED)
ament_package()
""",
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """This repository and a package that needs its interfaces, under src/."""
    root = tmp_path_factory.mktemp("workspace")
    left_out = (".*", "build", "install", "log", "out", "test", "bench", "docs", "*_?deg", "__pycache__")
    shutil.copytree(ROOT, root / "src" / "doormill_ros", ignore=shutil.ignore_patterns(*left_out))
    (root / "src" / "neighbour").mkdir()
    for name, text in NEIGHBOUR.items():
        (root / "src" / "neighbour" / name).write_text(text, encoding="utf-8")
    return root


def run(workspace: Path, command: str, *more: str) -> str:
    """What a command says in the workspace; it must succeed and leave no process."""
    words = [*shlex.split(command), *more]
    assert words[0] == "python"
    process = subprocess.Popen(
        [sys.executable, *words[1:]],
        cwd=workspace,
        env={**os.environ, "VIRTUAL_ENV": sys.prefix},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=LIMIT)
    except BaseException:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise
    assert process.returncode == 0, output
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)
    return output


def test_colcon_lists_all_packages_in_the_order_of_their_needs(workspace: Path) -> None:
    listed = BUILD.replace(" build ", " --log-base log list --names-only --topological-order ")
    lines = [line for line in run(workspace, listed).splitlines() if line in PACKAGES]
    assert sorted(lines) == sorted(PACKAGES)
    assert lines[0] == "doormill_interfaces"
    # Why the command names a second folder.
    assert "doormill_interfaces" not in run(workspace, "python -m colcon --log-base log list --names-only")


def test_rosdep_is_told_of_all_packages(workspace: Path) -> None:
    """It crawls with catkin_pkg."""
    folders = ROSDEP.split("--from-paths ")[1].split()
    found = {
        package.name for folder in folders for package in find_packages(str(workspace / folder)).values()
    }
    assert found == PACKAGES
    assert folders == BUILD.split("--base-paths ")[1].split()


def test_the_packages_are_built_beside_another(workspace: Path) -> None:
    """Both that need the interfaces; the interfaces themselves are compiled by `make setup`, with the same colcon."""
    run(workspace, BUILD, "--packages-skip", "doormill_interfaces")
    assert {path.name for path in (workspace / "install").iterdir() if path.is_dir()} == PACKAGES - {
        "doormill_interfaces"
    }
    tool = workspace / "install" / "doormill_ros" / "lib" / "doormill_ros" / "recipes"
    script = f". install/local_setup.bash && {tool} list && python -c 'import doormill_ros as d; print(d.__file__)'"
    done = subprocess.run(
        ["bash", "-c", script], cwd=workspace, capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "standard_door" in done.stdout
    assert Path(done.stdout.splitlines()[-1]).is_relative_to(workspace / "install")


def test_the_interfaces_are_configured_and_generated_where_they_lie(workspace: Path) -> None:
    target = "doormill_interfaces__rosidl_generator_type_description"
    run(workspace, BUILD, "--packages-select", "doormill_interfaces", "--cmake-target", target)
    made = {path.stem for path in (workspace / "build" / "doormill_interfaces").rglob("*.json")}
    sources = {path.stem for path in (ROOT / "doormill_interfaces").glob("*/*.*") if path.suffix != ".xml"}
    assert len(sources) >= 18
    assert sources - made == set()
