"""The robot model that a diagnosis of poses leaves behind, and its file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.model_file import read_model
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.registry import build_cause
from doormill_ros.robot_model.pose.chain import frames
from doormill_ros.robot_model.pose.law.term import PoseTerm, Sight
from doormill_ros.robot_model.pose.layout import design, frame_twists, lay_out
from doormill_ros.robot_model.pose.link_masses import LinkMass, published_masses
from doormill_ros.robot_model.pose.stance import UPRIGHT, Stance
from doormill_ros.robot_model.pose.view import SetView

SCHEMA = "doormill/extended-pose-model/1"


@dataclass(frozen=True, eq=False)
class PoseModel:
    """Nominal kinematics and the causes that hold for the robot whatever the series.

    Attributes:
        robot: Name of the robot.
        dh: Nominal table, shape (J, 4).
        links: Masses, empty where not known.
        causes: Established causes that transfer.
        x: Their coefficients in a row.
        laws: What no cause names, with weights, SI.
        stance: How the robot stands to gravity, and what it carries beyond its links.
    """

    robot: str
    dh: FloatArray
    links: tuple[LinkMass, ...]
    causes: tuple[PoseCause, ...]
    x: FloatArray
    laws: tuple[tuple[PoseTerm, FloatArray], ...] = ()
    stance: Stance = UPRIGHT

    def frames(self, view: SetView) -> FloatArray:
        """T_base_k of the displaced frames for a series, shape (n, J + 1, 4, 4).

        A law acts with its mean where the view does not hold what drives it.
        """
        view = view.at(self.stance)
        sight = Sight((view,))
        bases = design(view, lay_out([*self.causes, *(term for term, _ in self.laws)]))
        x = np.concatenate([self.x, *(term.from_values(weights, sight) for term, weights in self.laws)])
        return frames(view.transforms, frame_twists(bases, x, len(view.q), view.joints))

    def flange(self, q: FloatArray, motion: FloatArray | None = None) -> FloatArray:
        """T_base_flange, shape (n, 4, 4).

        Args:
            q: Recorded or commanded joint angles, shape (n, J) [rad].
            motion: Direction of each joint's last motion, -1, 0 (unknown) or +1, shape (n, J); None: unknown.
        """
        return self.frames(self.view(q, motion))[:, -1]

    def view(self, q: FloatArray, motion: FloatArray | None = None) -> SetView:
        """Joint angles, shape (n, J) [rad], as causes look at a series; `motion` as for `flange`."""
        q = np.atleast_2d(np.asarray(q, dtype=float))
        known = np.zeros(q.shape) if motion is None else np.broadcast_to(np.asarray(motion, float), q.shape)
        links = self.links or published_masses(self.robot, len(self.dh))
        return SetView("", self.dh, links, q, np.arange(len(q)), known, stance=self.stance)


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
        **({} if model.stance is UPRIGHT else {"stance": model.stance.document()}),
        "causes": causes,
        "series": list(others),
        **({"laws": [term.document(weights) for term, weights in model.laws]} if model.laws else {}),
    }


def load_pose_model(path: Path) -> PoseModel:
    """Read a model.yaml of a pose diagnosis, or the folder that holds it.

    Raises:
        PoseModelError: It cannot be read or used.
    """
    return read_model(path, SCHEMA, PoseModelError, _model)


def _model(document: dict[str, Any]) -> PoseModel:
    dh = np.array(document["dh"], dtype=float)
    links = tuple(LinkMass(float(k["mass"]), np.array(k["com"], dtype=float)) for k in document["links"])
    causes = tuple(
        build_cause(entry["cause"], str(entry["where"]), entry, dh) for entry in document["causes"]
    )
    x = np.concatenate(
        [np.zeros(0)] + [np.array(entry["coefficients"], dtype=float) for entry in document["causes"]]
    )
    if dh.ndim != 2 or dh.shape[1] != 4 or len(x) != lay_out(causes).size or not np.all(np.isfinite(x)):
        raise ValueError("the table or the coefficients have the wrong size")
    laws = tuple(PoseTerm.read(entry) for entry in document.get("laws", ()))
    stance = Stance.read(document["stance"]) if "stance" in document else UPRIGHT
    return PoseModel(str(document["robot"]), dh, links, causes, x, laws, stance)
