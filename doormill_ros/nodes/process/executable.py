"""Starts the executables of nodes without what a start would do for nothing: a fifth of its processor time.

While modules are loaded the collector goes over tens of thousands of objects that stay, and SciPy takes the texts that
describe its functions apart. Each message package asks for the generator of messages, with its parser. And the first
line of the log asks every module for its file.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import importlib.util
import inspect
import sys
from collections.abc import Callable
from functools import partial
from types import FrameType
from typing import Any

_GENERATOR = "rosidl_generator_py"


def __getattr__(name: str) -> Callable[[], int]:
    """What runs the executable of that name."""
    if name.startswith("_"):
        raise AttributeError(f"{__name__} has no {name}")
    return partial(run, name)


def run(name: str) -> int:
    """Load a module of `doormill_ros.nodes` and run it; returns its exit status."""
    gc.disable()
    leave_texts_whole()
    module = importlib.import_module(f"doormill_ros.nodes.{name}")
    leave_generator_out()
    find_lines_by_frames()
    # What loading left behind is little; to look for it takes longer than what it did.
    gc.freeze()
    gc.enable()
    status: int = module.main()
    return status


def leave_texts_whole() -> None:
    """Let SciPy write its note for other array libraries without reading what a function's text says beside it."""
    with contextlib.suppress(ImportError, AttributeError):
        importlib.import_module("scipy._lib._docscrape").NumpyDocString._parse = lambda _: None


def leave_generator_out() -> None:
    """Give message packages what loads their type support, which they ask the package of the generator for."""
    spec = importlib.util.find_spec(_GENERATOR)
    if spec is None or _GENERATOR in sys.modules:
        return
    package = importlib.util.module_from_spec(spec)
    sys.modules[_GENERATOR] = package
    loader = importlib.import_module(f"{_GENERATOR}.import_type_support_impl")
    package.import_type_support = loader.import_type_support  # type: ignore[attr-defined]


def find_lines_by_frames() -> None:
    """Let rclpy take file and line of a message to the log from the frame alone, without its source."""
    importlib.import_module("rclpy.impl.rcutils_logger").inspect = _Inspect()  # type: ignore[attr-defined]


class _Inspect:
    """The module `inspect` for rclpy's logger."""

    @staticmethod
    def getframeinfo(frame: FrameType) -> inspect.Traceback:
        code = frame.f_code
        return inspect.Traceback(code.co_filename, frame.f_lineno, code.co_name, None, None)

    def __getattr__(self, name: str) -> Any:
        return getattr(inspect, name)
