"""The spindle's load goes from the simulated controller over the bridge to the bag, and tells of a dull mill."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.abb import signals
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.diagnosis.runs.ungauged_run import ungauged_runs
from doormill_ros.nodes.base import topics
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.simulation.spindle_load import IDLE, NOISE
from support.cell_processes import CellProcesses

DOOR = "thesis_190_0deg"
#: Simulated over real seconds: the robot mills for some seconds, and is looked at some hundred times.
SCALE, PERIOD = 8.0, 0.01
#: Six standard deviations of the converter's noise.
CLEAR = 6.0 * NOISE
HARD, DULL = 3.0, 6.0  # times the work that wood takes usually, of the first door and of the second
WORLD = f"""schema: doormill/world/1
force: {{factor: {HARD}}}
change:
  - {{from_door: 1, force: {{factor: {DULL}}}}}
"""


def seconds(stamp: Any) -> float:
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def test_the_bag_holds_the_load_of_a_mill_and_of_a_duller_one(tmp_path: Path) -> None:
    world = tmp_path / "world.yaml"
    world.write_text(WORLD, encoding="utf-8")
    controller = {"controller_simulator:time_scale": SCALE, "controller_simulator:world": world}
    parameters = {"abb_bridge": {"spindle_load_period": PERIOD}, "cell_simulator": controller}
    with CellProcesses(tmp_path, parameters) as cell:
        results = [cell.mill(DOOR)[0] for _ in range(2)]
        # So large a force may bend the robot too far.
        told = [result.message for result in results]
        assert {result.error_code for result in results} <= {0, OutOfToleranceError.code}, told
        # Who holds the folder shows the analog input as the other signals.
        assert float((tmp_path / "HOME" / "io" / signals.SPINDLE_LOAD).read_text()) >= 0.0
    loads = [item.message for item in read_bag(tmp_path / "bag", [f"/{topics.SPINDLE_LOAD.name}"])]
    status = [item.message for item in read_bag(tmp_path / "bag", [f"/{topics.ABB_STATUS.name}"])]
    assert {message.run_id for message in loads} == {result.run_id for result in results}
    cuts = []
    for result in results:
        since = {m.state: seconds(m.since) for m in status if m.run_id == result.run_id}
        own = [message for message in loads if message.run_id == result.run_id]
        stamps = [seconds(message.header.stamp) for message in own]
        assert stamps == sorted(stamps)
        assert since["milling"] <= stamps[0]
        # The spindle turns in the air, and it cuts; nothing of it is beyond what its drive has.
        shares = np.array([message.load for message in own])
        assert shares.min() < IDLE + CLEAR < shares.max() < 1.5
        cuts.append(np.median(shares[shares > IDLE + CLEAR]) - IDLE)
    # How long a cut takes on the wall's clock hangs on the machine, how high it is does not.
    assert 1.4 < cuts[1] / cuts[0] < 2.6
    sharp, dull = (run.work for run in ungauged_runs(tmp_path))
    assert 0.0 < sharp < dull
