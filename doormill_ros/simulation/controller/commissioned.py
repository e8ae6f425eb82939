"""What a commissioned cell has beyond the modules as they are shipped: a measured tool, and a memory of doors."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from doormill_ros.abb.signals import REQUEST_FILE
from doormill_ros.simulation.controller.rapid.program import RapidProgram

#: PERS once the first tool is in the spindle and measured, and no door was begun.
_MEASURED = {"toolPlace": "1", "toolMeasured": "TRUE", "doorSpent": "FALSE"}
_REQUEST_NUMBER = "requestNumber"


def saved_data(program: RapidProgram, home: Path) -> Mapping[str, str]:
    """PERS as a controller has them that has kept them since the last request, and as people saved them into HOME.

    Args:
        program: What is loaded; PERS that it does not hold are left out.
        home: Folder behind HOME:.
    """
    try:
        number = (home / REQUEST_FILE).read_text().split()[0]
    except (OSError, UnicodeDecodeError, IndexError):
        number = ""
    data = {**_MEASURED, _REQUEST_NUMBER: number if number.isdigit() else "0"}
    return {name: literal for name, literal in data.items() if program.has_data(name)}


def restore(program: RapidProgram, data: Mapping[str, str]) -> None:
    """Give PERS the values that modules were saved with."""
    for name, literal in data.items():
        program.write(name, literal)
