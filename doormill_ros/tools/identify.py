"""identify: joint stiffness from loading tests, and process wrenches from a milling test.

`identify --data DIR --out OUT` takes a measurement set, `--raw DIR` a folder of laser tracker and force files
with loading_tests.yaml, `--thesis` the six tests of the thesis. Prints a table and writes identification.json
and robot.yaml (a robot with the identified stiffness, for `load_robot`).

`identify --milling DIR --out OUT` takes a force log with milling_log.yaml, prints the mean wrench of each segment
and writes wrench.yaml, whose lines a recipe's feature takes.
"""

from __future__ import annotations

import argparse
import logging
import sys
from pathlib import Path

import numpy as np

from doormill_ros.errors import DoormillError
from doormill_ros.identification.milling_log import ProcessForces, process_forces_of
from doormill_ros.identification.outcome import Outcome, add_preload, outcome_of_loadings
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(
        prog="identify", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    source = top.add_mutually_exclusive_group(required=True)
    source.add_argument("--data", metavar="DIR", type=Path, help="measurement set (set.yaml, trials.csv)")
    source.add_argument("--raw", metavar="DIR", type=Path, help="raw files with loading_tests.yaml")
    source.add_argument("--thesis", action="store_true", help="the six loading tests of the thesis")
    source.add_argument("--milling", metavar="DIR", type=Path, help="force log with milling_log.yaml")
    top.add_argument("--out", metavar="OUT", type=Path, required=True, help="folder for the results")
    return top


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0; 2 with one line on stderr and nothing written when the data cannot be used.
    """
    try:
        arguments = parser().parse_args(argv)
    except SystemExit as stop:  # --help, or a wrong command line
        return int(stop.code or 0)
    logging.basicConfig(level=logging.ERROR)
    try:
        outcome: Outcome | ProcessForces
        if arguments.milling is not None:
            outcome = process_forces_of(arguments.milling)
        elif arguments.thesis:
            outcome = from_thesis()
        elif arguments.raw is not None:
            outcome = from_raw(arguments.raw)
        else:
            outcome = from_measurement_set(arguments.data)
        files = outcome.write(arguments.out)
    except (DoormillError, OSError) as error:
        print(f"identify: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    print("\n".join(outcome.lines))
    print("wrote " + ", ".join(map(str, files)))
    return 0


def from_measurement_set(folder: Path) -> Outcome:
    """Identify from a measurement set.

    Raises:
        DataSetError: The set cannot be read or tells no joint.
    """
    from doormill_ros.identification.joint_by_joint import identify_joint_by_joint
    from doormill_ros.identification.outliers import fit_without_outliers
    from doormill_ros.identification.weighted import fit_by_preload
    from doormill_ros.measurements.loading import loadings_of_set
    from doormill_ros.measurements.sets.measurement_set import read_measurement_set
    from doormill_ros.robot.description import load_robot
    from doormill_ros.robot.kinematics import Kinematics

    measurements = read_measurement_set(folder)
    robot = load_robot(measurements.robot)
    kinematics = Kinematics(robot)
    loadings = loadings_of_set(kinematics, measurements)
    robust = fit_without_outliers(kinematics, loadings)
    kept = loadings.pick(robust.kept)
    steps = identify_joint_by_joint(kinematics, kept, measurements.joint_stiffness)
    source = f"measurement set {folder.resolve().name}"
    outcome = outcome_of_loadings(
        robot, source, steps, robust.fit, len(loadings), measurements.trial[robust.outliers]
    )
    if np.any(measurements.direction):
        add_preload(outcome, fit_by_preload(kinematics, kept, measurements.direction[robust.kept]))
    return outcome


def from_raw(folder: Path) -> Outcome:
    """Identify from raw laser tracker and force files.

    Raises:
        DataSetError: A file cannot be read, a recording is not steady, or no joint is told.
    """
    from doormill_ros.identification.joint_by_joint import identify_joint_by_joint
    from doormill_ros.identification.weighted import fit_stiffness
    from doormill_ros.measurements.raw.raw_set import read_raw_set
    from doormill_ros.robot.kinematics import Kinematics
    from doormill_ros.thesis.procedure import thesis_stiffness

    raw = read_raw_set(folder)
    kinematics = Kinematics(raw.robot)
    steps = identify_joint_by_joint(kinematics, raw.loadings, raw.robot.stiffness)
    fit = fit_stiffness(kinematics, raw.loadings)
    source = f"raw loading tests {folder.resolve().name}"
    outcome = outcome_of_loadings(raw.robot, source, steps, fit, len(raw.loadings))
    found = thesis_stiffness(kinematics, raw.tests, raw.robot.stiffness)
    if found:
        outcome.lines.append("by the thesis' formulas:")
        outcome.lines.extend(
            f"{f.joint:>5} {f.stiffness:11.4g}   (equations {f.equations}, {f.test})" for f in found
        )
        outcome.document["thesis_formulas"] = [vars(f) for f in found]
    outcome.document["windows"] = {
        name: {
            "duration": window.duration,
            "samples": window.stop - window.start,
            "mean": window.mean,
            "standard_error": window.standard_error,
        }
        for name, window in raw.windows.items()
    }
    return outcome


def from_thesis() -> Outcome:
    """Identify from the tests that the thesis prints."""
    from doormill_ros.thesis.loading_tests import load_thesis_data
    from doormill_ros.thesis.outcome import outcome_of_thesis

    return outcome_of_thesis(load_thesis_data())


if __name__ == "__main__":
    sys.exit(main())
