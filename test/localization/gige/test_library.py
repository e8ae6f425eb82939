"""Aravis is needed by nobody but its node, is found where the system keeps it, and is missed with a sentence."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from support.cell_processes import executable
from support.source_tree import ROOT
from support.waiting import LIMIT

LOAD = """
import sys
from doormill_ros.localization.gige.errors import AravisMissing
from doormill_ros.localization.gige.library import load_aravis
try:
    print(load_aravis(sys.argv[1]).names.Camera)
except AravisMissing as error:
    print(error.code, error.message)
print(sorted(name for name in sys.modules if name.split(".")[0] == "gi"))
"""
#: What the package `gi` of a system may be, and what is said of it.
SYSTEMS = {
    "none": ({}, "there is no gi on Python's path"),
    "of another Python": (
        {"__init__.py": "from gi import _gi\n"},
        "cannot import name '_gi'",
    ),
    "without aravis": (
        {
            "__init__.py": "def require_version(name, version):\n"
            "    raise ValueError(f'Namespace {name} not available')\n"
        },
        "Namespace Aravis not available",
    ),
}


def load(system: Path) -> list[str]:
    """What a Python without any packages prints."""
    done = subprocess.run(
        [sys.executable, "-S", "-c", LOAD, system],
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=True,
    )
    return done.stdout.splitlines()


def put(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / "gi").mkdir(exist_ok=True)
        (folder / "gi" / name).write_text(text)


@pytest.mark.parametrize(("files", "said"), SYSTEMS.values(), ids=SYSTEMS)
def test_what_is_missing_is_said_with_what_to_do(tmp_path: Path, files: dict[str, str], said: str) -> None:
    put(tmp_path, files)
    (sentence, _) = load(tmp_path)
    assert sentence.startswith("241 aravis cannot be loaded (")
    assert said in sentence
    assert "install libaravis-0.8-0, gir1.2-aravis-0.8 and python3-gi, or PyGObject by pip" in sentence


def test_a_package_that_cannot_be_loaded_leaves_nothing_behind(tmp_path: Path) -> None:
    put(tmp_path, SYSTEMS["of another Python"][0])
    assert load(tmp_path)[1] == "[]"


def test_of_the_systems_packages_only_that_one_is_let_in(tmp_path: Path) -> None:
    repository = {
        "Aravis.py": "from gi.repository import Camera\n",
        "GLib.py": "Error = RuntimeError\n",
        "__init__.py": "class Camera: pass\n",
    }
    put(tmp_path, {"__init__.py": "def require_version(name, version): pass\n"})
    (tmp_path / "gi" / "repository").mkdir()
    for name, text in repository.items():
        (tmp_path / "gi" / "repository" / name).write_text(text)
    (tmp_path / "numpy.py").write_text("raise SystemExit('the system gave more than was asked for')\n")
    found, modules = load(tmp_path)
    assert found == "<class 'gi.repository.Camera'>"
    assert modules == "['gi', 'gi.repository', 'gi.repository.Aravis', 'gi.repository.GLib']"


def test_the_node_can_be_imported_without_it() -> None:
    text = (
        "import sys\nimport doormill_ros.nodes.gige_camera, doormill_ros.localization.gige.aravis_device\n"
        "print('gi' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=ROOT, capture_output=True, text=True, timeout=LIMIT, check=True
    )
    assert done.stdout == "False\n"


def test_the_executable_ends_with_the_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the status after which no service starts it again."""
    put(tmp_path, SYSTEMS["of another Python"][0])
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    done = subprocess.run([executable("gige_camera")], capture_output=True, text=True, timeout=LIMIT)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "aravis cannot be loaded (cannot import name '_gi'" in done.stderr
    assert "Traceback" not in done.stderr
