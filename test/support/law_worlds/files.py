"""A session as the two files of doormill/measurement-set/1."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import yaml

from support.law_worlds.geometry import ROBOT, SPRINGS
from support.law_worlds.session import REFLECTORS, SENSOR_ROTATION, Session

HEADER = "trial t dt temperature q1 q2 q3 q4 q5 q6 a1 a2 a3 a4 a5 a6 fx fy fz mx my mz reflector dx dy dz"


def write_set(
    folder: Path,
    session: Session,
    wrench: np.ndarray,
    displacement: np.ndarray,
    rows: np.ndarray,
    noise: tuple[float, float, float],
) -> None:
    """Write set.yaml and trials.csv.

    Args:
        folder: Made if it is not there.
        session: What was done.
        wrench: As read, sensor axes, shape (n, 6) [N, N m].
        displacement: As measured, base frame, shape (n, 3) [m].
        rows: Which rows to write, shape (n,); a trial's number is its place in the session.
        noise: Stated for displacement [m], force [N], torque [N m].
    """
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "schema": "doormill/measurement-set/1",
        "robot": ROBOT,
        "model": {"joint_stiffness": SPRINGS.tolist()},
        "noise": dict(zip(("displacement", "force", "torque"), noise, strict=True)),
        "wrench_frame_rotation": SENSOR_ROTATION,
        "load_point": session.load_point.tolist(),
        "reflectors": {
            name: {"link": link, "position": position.tolist()}
            for name, (link, position) in REFLECTORS.items()
        },
    }
    (folder / "set.yaml").write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    with open(folder / "trials.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEADER.split())
        for i in np.flatnonzero(rows):
            table.writerow(
                [i + 1, f"{session.t[i]:.3f}", f"{session.dt[i]:.3f}", f"{session.air[i]:.2f}"]
                + [f"{value:.9g}" for value in session.q[i]]
                + [f"{value:.0f}" for value in session.approach[i]]
                + [f"{value:.6f}" for value in wrench[i]]
                + [session.reflector[i]]
                + [f"{value:.9e}" for value in displacement[i]]
            )
