"""The robot model that a diagnosis of poses leaves behind, and its file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.config import read_document
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.registry import build_cause
from doormill_ros.robot_model.pose.chain import frames
from doormill_ros.robot_model.pose.layout import design, frame_twists, lay_out
from doormill_ros.robot_model.pose.view import KNOWN_LINKS, LinkMass, SetView

SCHEMA = "doormill/extended-pose-model/1"


@dataclass(frozen=True, eq=False)
class PoseModel:
    """Nominal kinematics and the causes that hold for the robot whatever the series.

    Attributes:
        robot: Name of the robot.
        dh: Nominal table, shape (6, 4).
        links: Masses, empty where not known.
        causes: Established causes that transfer.
        x: Their coefficients in a row.
    """

    robot: str
    dh: FloatArray
    links: tuple[LinkMass, ...]
    causes: tuple[PoseCause, ...]
    x: FloatArray

    def frames(self, view: SetView) -> FloatArray:
        """T_base_k of the displaced frames for a series, shape (n, 7, 4, 4)."""
        return frames(view.transforms, frame_twists(design(view, lay_out(self.causes)), self.x, len(view.q)))

    def flange(self, q: FloatArray, motion: FloatArray | None = None) -> FloatArray:
        """T_base_flange, shape (n, 4, 4).

        Args:
            q: Recorded or commanded joint angles, shape (n, 6) [rad].
            motion: Direction of each joint's last motion, -1, 0 (unknown) or +1, shape (n, 6); None: unknown.
        """
        return self.frames(view_of(self, q, motion))[:, -1]


def view_of(model: PoseModel, q: FloatArray, motion: FloatArray | None = None) -> SetView:
    """Joint angles (n, 6) [rad] as causes look at a series; `motion` as for `PoseModel.flange`."""
    q = np.atleast_2d(np.asarray(q, dtype=float))
    known = np.zeros(q.shape) if motion is None else np.broadcast_to(np.asarray(motion, float), q.shape)
    return SetView("", model.dh, model.links or KNOWN_LINKS.get(model.robot, ()), q, np.arange(len(q)), known)


def model_document(model: PoseModel, source: str, others: Sequence[dict[str, Any]] = ()) -> dict[str, Any]:
    """The content of model.yaml; `others` belong to the series and are kept for the record."""
    layout = lay_out(model.causes)
    causes = []
    for index, cause in enumerate(model.causes):
        entry: dict[str, Any] = {"cause": cause.name, "where": cause.where, **cause.settings}
        entry["coefficients"] = [float(v) for v in model.x[layout.part(index)]]
        causes.append(entry)
    return {
        "schema": SCHEMA,
        "robot": model.robot,
        "source": source,
        "dh": [[float(v) for v in row] for row in model.dh],
        "links": [{"mass": float(k.mass), "com": [float(v) for v in k.com]} for k in model.links],
        "causes": causes,
        "series": list(others),
    }


def load_pose_model(path: Path) -> PoseModel:
    """Read a model.yaml of a pose diagnosis, or the folder that holds it.

    Raises:
        PoseModelError: It cannot be read or used.
    """
    path = path / "model.yaml" if path.is_dir() else path
    document = read_document(path, PoseModelError)
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        found = document.get("schema") if isinstance(document, dict) else type(document).__name__
        raise PoseModelError(f"{path} has schema {found}, allowed is {SCHEMA}", path=str(path))
    try:
        dh = np.array(document["dh"], dtype=float)
        links = tuple(LinkMass(float(k["mass"]), np.array(k["com"], dtype=float)) for k in document["links"])
        causes = tuple(
            build_cause(entry["cause"], str(entry["where"]), entry, dh) for entry in document["causes"]
        )
        x = np.concatenate(
            [np.zeros(0)] + [np.array(entry["coefficients"], dtype=float) for entry in document["causes"]]
        )
        if dh.shape != (6, 4) or len(x) != lay_out(causes).size or not np.all(np.isfinite(x)):
            raise ValueError("the table or the coefficients have the wrong size")
    except (KeyError, TypeError, ValueError) as error:
        raise PoseModelError(
            f"{path} cannot be used: {error}; write it anew with diagnose", path=str(path)
        ) from error
    return PoseModel(str(document["robot"]), dh, links, causes, x)
