"""What every process of the campaign needs, made once: the server that forks them loads this module.

The RAPID modules are parsed in here, which takes longer than all doors of a run.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from support.faults import bridge, rapid_robot
from support.faults.scenario import Scenario
from support.faults.world import World, make_file

__all__ = ["bridge", "rapid_robot"]

with tempfile.TemporaryDirectory() as _folder:
    rapid_robot.RapidRobot(World.create(Path(_folder) / "run"), Scenario(0, "no fault"), 0)
    make_file(0, "door_a", "run")
