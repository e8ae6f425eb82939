"""The rules of the house, read from the source: who may import what, and how large a file gets."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from doormill_ros.errors import error_classes
from support.source_tree import PACKAGE, ROOT, SOURCES, imports_of

ROS_ONLY = {
    "rclpy",
    "launch",
    "launch_ros",
    "rosidl_runtime_py",
    "tf2_ros",
    "cv_bridge",
    "ament_index_python",
}
LONGEST_FILE = 350  # lines
LONG_FILE, MOST_FILES = 250, 0.9  # lines, and the share of the files that keeps to them
#: Command lines that start nodes in their own process.
TOOLS_WITH_NODES = {"calibrate.py", "cell.py", "health.py", "replay.py"}
# The truth of the simulation must not come from the code under test.
TRUTH_MAY_NOT_IMPORT = {"robot", "robot_model", "localization", "correction", "diagnosis"}


def is_ros(module: str) -> bool:
    """True for rclpy and everything that only a ROS environment has, messages included."""
    top = module.split(".")[0]
    return top in ROS_ONLY or top.endswith(("_msgs", "_interfaces", "_srvs"))


def test_there_is_something_to_check() -> None:
    assert len(SOURCES) > 60


DOMAIN = [path for path in SOURCES if path.relative_to(PACKAGE).parts[0] != "nodes"]


@pytest.mark.parametrize("path", DOMAIN, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_domain_code_knows_no_ros(path: Path) -> None:
    """Only nodes/ imports rclpy or messages, and only `TOOLS_WITH_NODES` start nodes."""
    parts = path.relative_to(PACKAGE).parts
    ros = {m for m in imports_of(path) if is_ros(m)}
    assert not ros, f"{path} imports {ros}"
    nodes = {m for m in imports_of(path) if m.startswith("doormill_ros.nodes")}
    assert not nodes or (parts[0] == "tools" and parts[1] in TOOLS_WITH_NODES), f"{path} imports {nodes}"


def test_the_check_above_sees_a_forbidden_import(tmp_path: Path) -> None:
    path = tmp_path / "bad.py"
    path.write_text("def f():\n    from sensor_msgs.msg import Image\n    return Image\n")
    assert any(is_ros(m) for m in imports_of(path))


def _simulated_truth() -> list[Path]:
    return sorted((PACKAGE / "simulation").rglob("*.py"))


@pytest.mark.parametrize("path", _simulated_truth(), ids=lambda p: p.name)
def test_the_simulated_truth_shares_no_model_with_what_it_judges(path: Path) -> None:
    packages = {m.split(".")[1] for m in imports_of(path) if m.startswith("doormill_ros.")}
    assert not packages & TRUTH_MAY_NOT_IMPORT


def test_files_stay_small() -> None:
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    too_long = {str(p.relative_to(ROOT)): n for p, n in lines.items() if n > LONGEST_FILE}
    assert not too_long
    assert sum(n <= LONG_FILE for n in lines.values()) >= MOST_FILES * len(lines)


def test_every_error_that_can_be_raised_has_a_code_of_its_own() -> None:
    classes = error_classes()
    leaves = [cls for cls in classes if not cls.__subclasses__()]
    assert len(leaves) > 40
    codes: dict[int, str] = {}
    for cls in leaves:
        assert "code" in vars(cls), f"{cls.__name__} has no code of its own"
        assert cls.code not in codes, f"{cls.__name__} and {codes[cls.code]} share code {cls.code}"
        codes[cls.code] = cls.__name__


RANGES = {
    "recipes": (100, 199),
    "localization": (200, 299),
    "toolpath": (300, 399),
    "correction": (300, 399),
    "abb": (400, 499),
    "simulation.controller.rapid": (400, 499),
    "simulation": (850, 899),
    "operator": (800, 899),
    "measurements": (500, 599),
    "robot_model": (500, 599),
    "diagnosis": (500, 599),
    "identification": (500, 599),
    "recording": (600, 699),
    "backup": (600, 699),
    "report": (600, 699),
    "robot": (700, 799),
    "workspace": (700, 799),
    "cell": (800, 899),
    "catalogue": (860, 865),
    "parallel": (866, 869),
    "models": (800, 899),
    "monitor": (800, 899),
}


def test_error_codes_stay_in_the_range_of_their_package() -> None:
    judged = []
    for cls in error_classes():
        room = cls.__module__.removeprefix("doormill_ros.").rpartition(".")[0]
        package = room if room in RANGES else room.partition(".")[0]
        if package in RANGES and "code" in vars(cls):
            low, high = RANGES[package]
            assert low <= cls.code <= high, f"{cls.__name__} has code {cls.code}, its range is {low}..{high}"
            judged.append(cls)
    assert len(judged) > 40


def test_conversions_to_millimetres_and_degrees_stay_at_the_edges() -> None:
    """np.deg2rad and friends are spelled by doormill_ros.units alone."""
    others = [path for path in SOURCES if path != PACKAGE / "units.py"]
    assert len(others) == len(SOURCES) - 1
    for path in others:
        text = path.read_text(encoding="utf-8")
        for word in ("deg2rad", "rad2deg", "math.radians", "math.degrees", "np.radians", "np.degrees"):
            assert word not in text, f"{path.relative_to(ROOT)} spells {word}; use doormill_ros.units"


THOUSANDS = {1e3, 1e6, 1e-3, 1e-6}


def spelled_conversions(tree: ast.AST) -> list[int]:
    """Lines that multiply or divide by a power of a thousand, or give one the name of a unit."""
    lines = []
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
            factors = [node.left, node.right]
        elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Mult | ast.Div):
            factors = [node.value]
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            unit = node.targets[0].id.strip("_").upper() in ("MM", "UM", "MS")
            factors = [node.value] if unit else []
        else:
            continue
        if any(isinstance(factor, ast.Constant) and factor.value in THOUSANDS for factor in factors):
            lines.append(node.lineno)
    return sorted(lines)


def test_the_scan_sees_a_spelled_conversion() -> None:
    text = "a = 1e6 * b\nb = a / 1000\nb *= 1e-3\n_UM = 1e-6\nlimit = 1e-6\nb = a * 1e-9\n"
    assert spelled_conversions(ast.parse(text)) == [1, 2, 3, 4]


def test_conversions_by_thousands_are_functions_of_units() -> None:
    """Metres to millimetres and the like are called by name."""
    spelled = {
        str(path.relative_to(ROOT)): lines
        for path in SOURCES
        if path.name != "units.py"
        if (lines := spelled_conversions(ast.parse(path.read_text(encoding="utf-8"))))
    }
    assert spelled == {}


def doubled(sources: dict[str, str]) -> dict[str, list[str]]:
    """Names of public classes of more than one file, with the files."""
    files: dict[str, list[str]] = {}
    for path, text in sources.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                files.setdefault(node.name, []).append(path)
    return {name: paths for name, paths in files.items() if len(paths) > 1}


def test_the_scan_sees_a_doubled_name() -> None:
    sources = {"a.py": "class Step:\n    class _Own: ...\n", "b.py": "class Step: ...\nclass _Own: ...\n"}
    assert doubled(sources) == {"Step": ["a.py", "b.py"]}


def test_a_class_name_means_one_thing() -> None:
    """Private classes speak to their file alone and may share a name."""
    texts = {str(path.relative_to(PACKAGE)): path.read_text(encoding="utf-8") for path in SOURCES}
    assert len(texts) > 200
    assert doubled(texts) == {}
