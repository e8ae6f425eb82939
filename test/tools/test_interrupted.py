"""Every command line tool ends of an interrupt in one word."""

from __future__ import annotations

import argparse
import importlib
import inspect
import pkgutil
import signal
import sys
from typing import Any

import pytest

from doormill_ros import tools
from doormill_ros.interrupts import interrupt_once

TOOLS = [
    module.name
    for module in pkgutil.iter_modules(tools.__path__)
    if hasattr(importlib.import_module(f"{tools.__name__}.{module.name}"), "main")
]


def interrupted(*_: Any, **__: Any) -> None:
    raise KeyboardInterrupt


def test_tools_are_found() -> None:
    assert {"cell", "diagnose", "recipes", "replay", "report", "workspace"} <= set(TOOLS)


@pytest.mark.parametrize("tool", TOOLS)
def test_an_interrupt_is_told_in_one_word(
    tool: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    module = importlib.import_module(f"{tools.__name__}.{tool}")
    monkeypatch.setattr("sys.excepthook", sys.__excepthook__)  # as in a process of its own
    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", interrupted)
    assert module.main([]) == 130
    assert tuple(capsys.readouterr()) == ("", "interrupted\n")
    assert inspect.getdoc(module.main)


def test_a_process_that_tells_of_it_itself_dies_of_the_signal(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module(f"{tools.__name__}.cell")
    monkeypatch.setattr("sys.excepthook", sys.__excepthook__)  # is put back
    interrupt_once(())
    monkeypatch.setattr(argparse.ArgumentParser, "parse_args", interrupted)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        module.main([])
    assert signal.getsignal(signal.SIGINT) == before
