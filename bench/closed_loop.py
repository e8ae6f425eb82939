"""The loop from doors to doors: `python bench/closed_loop.py --world FILE --doors 40 --accept 30 --out DIR`.

Mills a shift in the simulated cell with /model_monitor beside it, accepts by its service what it proposes after the
first doors, mills the other doors, and prints what the doors say and how those of the same recipes came out before and
after. No fit has seen the doors after.
"""

from __future__ import annotations

import argparse
import itertools
import json
import logging
import shutil
import sys
from pathlib import Path

import numpy as np
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from doormill_interfaces.srv import AcceptModel
from doormill_ros.cell.output.run_folder import ShiftFolder
from doormill_ros.diagnosis.core.kind import run
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.measurements.inspections.inspection import read_inspection
from doormill_ros.monitor.watch_state import WatchState
from doormill_ros.nodes.one_process.cell import CellOptions
from doormill_ros.nodes.one_process.monitor_beside import ModelMonitorBeside
from doormill_ros.nodes.one_process.shift import run_shift
from doormill_ros.statistics import bootstrap_ratio
from doormill_ros.units import m_to_um

PATIENCE = 3600.0  # s, for a verdict on a machine that does other things
ANSWER = 60.0  # s


def main() -> int:
    """Mill, be questioned, accept, mill, compare; 0 when every recipe came out measurably better than before."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", type=Path, required=True)
    parser.add_argument("--door", action="append", default=[], metavar="ID")
    parser.add_argument("--doors", type=int, default=40)
    parser.add_argument("--accept", type=int, default=30, help="doors after which the model is accepted")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    kinds = arguments.door or ["thesis_190_0deg", "thesis_1350_0deg"]
    doors = list(itertools.islice(itertools.cycle(kinds), arguments.doors))
    shift = arguments.out / "shift"
    # The limit would stop the shift at once: such a world mills out of tolerance until a model is accepted.
    parameters = {"model_monitor": {"limit.expected": 0.0}, "controller_simulator": {"gauged": True}}
    options = CellOptions(parameters)
    shutil.rmtree(shift / "models", ignore_errors=True)
    ShiftFolder(shift.resolve()).prepare(len(doors))
    with ModelMonitorBeside(shift, options) as monitor:

        def accepted(number: int) -> None:
            """Before the door of that number: who accepts waits until all doors are questioned."""
            if number != arguments.accept:
                return
            state = monitor.verdict(PATIENCE)
            print(f"after {number} doors: {_sentence(state)}", flush=True)
            accept(state.proposed)
            print(f"version {monitor.verdict(PATIENCE).version} is in use", flush=True)

        run_shift(doors, shift, options, arguments.world, milled=_told, model=accepted)
        print(f"after {len(doors)} doors: {_sentence(monitor.verdict(PATIENCE))}", flush=True)
    before, after = (arguments.out / name for name in ("before", "after"))
    gather(shift, range(arguments.accept), before)
    gather(shift, range(arguments.accept, arguments.doors), after)
    print(run(Inspections(), [before], [after], arguments.out / "report"))
    document = json.loads((arguments.out / "report" / "diagnosis.json").read_text(encoding="utf-8"))
    for change in document["changes"]:
        print(
            f"{change['what']} at {change['where']}: {change['kind']} from {change['from_door']}, 95 %",
            " to ".join(change["from_door_ci95"]),
        )
    late = arguments.accept - (arguments.doors - arguments.accept)
    rows = [compared(shift, doors, kind, late, arguments.accept) for kind in kinds]
    print(f"report {arguments.out / 'report' / 'report.html'}")
    return int(not all(rows))


def _sentence(state: WatchState) -> str:
    return state.finding.sentence if state.finding is not None else state.message


def accept(version: int) -> None:
    """Accept a model as a person does: by the service of the monitor."""
    context = Context()
    rclpy.init(context=context)
    node, executor = Node("engineer", context=context), SingleThreadedExecutor(context=context)
    try:
        client = node.create_client(AcceptModel, "model/accept")
        client.wait_for_service(ANSWER)
        asked = client.call_async(AcceptModel.Request(version=version, who="bench", why="the doors say so"))
        executor.add_node(node)
        executor.spin_until_future_complete(asked, ANSWER)
        answer = asked.result()
        if answer is None or not answer.success:
            raise SystemExit(f"version {version} was not accepted: {answer and answer.message}")
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)


def gather(shift: Path, numbers: range, folder: Path) -> None:
    """Link inspections and bags of some doors below a folder of their own."""
    shutil.rmtree(folder, ignore_errors=True)
    for number in numbers:
        source = ShiftFolder(shift.resolve()).run(number)
        if source.inspection.is_dir():
            (folder / source.root.name).mkdir(parents=True)
            for part in (source.inspection, source.bag):
                (folder / source.root.name / part.name).symlink_to(part)


def compared(shift: Path, doors: list[str], kind: str, first: int, accepted: int) -> bool:
    """Print how the walls of one recipe came out before and after; whether they are better beyond chance.

    Args:
        shift: Its folder.
        doors: What each of them is.
        kind: The recipe.
        first: Number of the first door that counts as before.
        accepted: Number of the first door after.
    """
    rows = []
    for numbers in (range(first, accepted), range(accepted, len(doors))):
        folders = [ShiftFolder(shift).run(n).inspection for n in numbers if doors[n] == kind]
        found = [read_inspection(folder) for folder in folders if folder.is_dir()]
        rows.append([one.deviation[one.wall] for one in found])
    before, after = rows
    if not before or not after:
        print(f"{kind}: {len(before)} doors before, {len(after)} after; the others were refused")
        return False
    count = min(len(before), len(after))
    ratio, (_, high) = bootstrap_ratio(
        *(np.array([np.mean(off**2) for off in side[-count:]]) for side in rows)
    )
    told = [
        f"{len(side)} doors with {m_to_um(float(np.sqrt(np.mean(np.concatenate(side) ** 2)))):.0f} um rms, "
        f"{m_to_um(max(float(np.abs(off).max()) for off in side)):.0f} at most"
        for side in rows
    ]
    print(f"{kind}: walls of {told[0]} before; of {told[1]} after; {ratio:.2f} of it, 95 %: below {high:.2f}")
    return high < 1.0


def _told(number: int, summary: object) -> None:
    print(f"door {number}: {getattr(summary, 'message', '')}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
