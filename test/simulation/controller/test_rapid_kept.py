"""Syntax trees of shipped modules are kept on the disk, and taken from there only as they were made."""

from __future__ import annotations

import hashlib
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.kept import kept
from doormill_ros.simulation.controller.rapid.parser import parse_module

TEXTS = ("MODULE A PROC main() x := 1; ENDPROC ENDMODULE", "MODULE B CONST num b := 2; ENDMODULE")
SWITCHED_ON = """
import hashlib, sys
from pathlib import Path
from doormill_ros.nodes.simulated.controller_simulator import switch_on
controller = switch_on(Path(sys.argv[1])).controller
print(hashlib.sha256(repr(controller._modules).encode()).hexdigest(), len(controller._modules), "lark" in sys.modules)
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where trees are kept."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "doormill_ros" / "rapid"


class Parsing:
    """Parses, and counts how often it was asked to."""

    def __init__(self, texts: tuple[str, ...] = TEXTS) -> None:
        self.texts, self.times = texts, 0

    def __call__(self) -> tuple[s.Module, ...]:
        self.times += 1
        return tuple(parse_module(text) for text in self.texts)


def taken(texts: tuple[str, ...] = TEXTS) -> int:
    """How often a process that wants the trees of some texts has to parse them; the trees are right."""
    parse = Parsing(texts)
    assert kept("trees", texts, parse) == tuple(parse_module(text) for text in texts)
    return parse.times


def test_the_second_process_parses_nothing(tmp_path: Path, folder: Path) -> None:
    def told() -> list[str]:
        command = [sys.executable, "-c", SWITCHED_ON, str(tmp_path / "HOME")]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()

    first, second = told(), told()
    assert first[1:] == [str(len(OWN_MODULES)), "True"]
    assert second == [*first[:2], "False"]
    assert sorted(path.name for path in folder.iterdir()) == ["heads", "modules"]


def test_trees_of_other_texts_are_not_taken(folder: Path) -> None:
    assert [taken(), taken(), taken(TEXTS[:1]), taken(TEXTS[:1]), taken()] == [1, 0, 1, 0, 1]


@pytest.mark.parametrize("place", [0, 40, 70, -1])
def test_a_damaged_file_is_not_taken(folder: Path, place: int) -> None:
    taken()
    data = bytearray((folder / "trees").read_bytes())
    data[place] ^= 1
    (folder / "trees").write_bytes(data)
    assert [taken(), taken()] == [1, 0]


@pytest.mark.parametrize("length", [0, 31, 64, 100])
def test_half_a_file_is_not_taken(folder: Path, length: int) -> None:
    taken()
    os.truncate(folder / "trees", length)
    assert [taken(), taken()] == [1, 0]


class Harmful:
    """Runs a command when it is read."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (os.environ["HARM"],)


@pytest.mark.parametrize("content", [(Harmful(), Harmful()), ("A", "B"), [1, 2], 3, ()])
def test_what_is_no_tree_is_not_taken_whoever_made_it(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, content: Any
) -> None:
    monkeypatch.setenv("HARM", str(tmp_path / "harm"))
    taken()
    key = (folder / "trees").read_bytes()[:32]
    made = pickle.dumps(content)
    (folder / "trees").write_bytes(key + hashlib.sha256(made).digest() + made)
    assert [taken(), taken()] == [1, 0]
    assert not (tmp_path / "harm").exists()


def test_without_a_place_to_write_each_process_parses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert [taken(), taken()] == [1, 1]
