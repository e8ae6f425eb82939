"""Coverage-guided fuzzing of the target-file reader and the RAPID parser; needs `pip install atheris`.

Usage: `python bench/fuzz_rapid.py reader|parser [libFuzzer arguments, such as -max_total_time=60]`.
Anything but a stated error ends the run and leaves the input in a file crash-*.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

import atheris

with atheris.instrument_imports(include=["doormill_ros.abb"]):
    from doormill_ros.abb.errors import AbbError
    from doormill_ros.abb.target_file.target_file import read_target_file
    from doormill_ros.simulation.controller.rapid.parser import parse_module


def read(data: bytes) -> None:
    """One input for the reader."""
    try:
        read_target_file(data)
    except AbbError as error:
        if type(error) is AbbError or "allowed" not in error.message:
            raise RuntimeError(f"an error that does not say what is allowed: {error!r}") from error


def parse(data: bytes) -> None:
    """One input for the parser."""
    try:
        parse_module.__wrapped__(data.decode("latin-1"), "fuzz.mod")
    except AbbError as error:
        if not error.message.startswith("fuzz.mod"):
            raise RuntimeError(f"an error that does not name the file: {error!r}") from error


def main() -> None:
    """Fuzz what the first argument names."""
    target = {"reader": read, "parser": parse}[sys.argv.pop(1)]
    atheris.Setup(sys.argv, target)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
