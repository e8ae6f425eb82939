"""A kind of data that nobody thought of: a problem, its causes and one line make it a diagnosis like the others."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.core.document import diagnosis_document, write_diagnosis
from doormill_ros.diagnosis.core.margins import margins
from doormill_ros.diagnosis.core.problem import Examined, Prediction, make_folds
from doormill_ros.robot_model.candidate import Candidate, Parameter
from doormill_ros.tools.diagnose import main

SCHEMA = "invented/room-set/1"


class Draught(Candidate):
    """The thermometers of a room read too much, in proportion to a column of numbers."""

    def __init__(self, name, column, named=True, of_robot=True):
        super().__init__("room")
        self.name, self.column, self.named, self.of_robot = name, column, named, of_robot
        self.parameters = (Parameter("size", "K", -10.0, 10.0),)
        self.scale, self.lower, self.upper = np.ones(1), np.full(1, -1e3), np.full(1, 1e3)

    def values(self, theta, case):
        return np.array(theta)

    def pattern(self):
        return f"all readings follow the {self.name}"


class Room(Examined[Draught]):
    """Three thermometers read in many rooms, each room on several days."""

    def __init__(self, readings, room, library):
        self.readings, self.library, self.configuration = readings, library, room
        self.components, self.noise_floor, self.folds = 3, 0.1, make_folds(room)

    case = None

    def __len__(self):
        return len(self.readings)

    def slope(self, cause, theta):
        return np.repeat(cause.column[:, None, None], 3, axis=1) / self.noise_floor

    def predict(self, members, theta, derivative=False):
        slopes = [self.slope(cause, theta) for cause in members]
        jacobian = np.concatenate([np.zeros((len(self), 3, 0)), *slopes], axis=2)
        white = self.readings / self.noise_floor - jacobian @ theta
        return Prediction(
            white * self.noise_floor, white, np.sum(white**2, axis=1), jacobian if derivative else None
        )

    def measured_part(self, white):
        return white * self.noise_floor

    def candidates(self):
        return list(self.library)

    def bent(self):
        return None

    def cuts(self):
        return {"first": np.arange(len(self)) % 2 == 0}

    def groupings(self):
        return (self.configuration,)

    def turning(self, residual, gross):
        return "", 1.0

    def labels(self):
        return np.arange(1, len(self) + 1)


def a_room(hidden, seed=0, size=3.0):
    """Readings under the sun, the wind (the same as the fan), or a draught without a name."""
    rng = np.random.default_rng(seed)
    sun, wind, strange = rng.normal(size=(3, 60))
    library = [
        Draught("fan", wind),
        Draught("sun", sun),
        Draught("wind", wind, of_robot=False),
        Draught("strange", strange, named=False),
    ]
    columns = {cause.name: cause.column for cause in library}
    truth = sum((size * columns[name] for name in hidden), np.zeros(60))
    readings = truth[:, None] + rng.normal(0.0, 0.1, (60, 3))
    return Room(readings, np.arange(60) // 5, library)


def run_rooms(data, check, out, progress):
    hidden = yaml.safe_load((data[0] / "set.yaml").read_text())["hidden"]
    diagnosis = diagnose_problem(a_room(hidden), progress)
    document = diagnosis_document(
        diagnosis, "open a window", margins=[margin.document() for margin in margins(diagnosis)]
    )
    write_diagnosis(out, document, {}, "")
    return f"{diagnosis.verdict}: {', '.join(f.cause.name for f in diagnosis.findings)}"


@pytest.mark.parametrize(
    ("hidden", "verdict", "names"),
    [
        ([], "consistent", []),
        (["sun"], "explained", ["sun"]),
        (["sun", "wind"], "explained", ["sun", "wind"]),
        (["strange"], "unexplained", []),
        (["strange", "sun"], "partly_explained", ["sun"]),
    ],
)
def test_one_line_makes_a_kind(monkeypatch, tmp_path, capsys, hidden, verdict, names):
    monkeypatch.setitem(kinds.KINDS, SCHEMA, run_rooms)
    (tmp_path / "set.yaml").write_text(yaml.safe_dump({"schema": SCHEMA, "hidden": hidden}))
    assert main(["--data", str(tmp_path), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert document["verdict"] == verdict
    assert sorted(cause["cause"] for cause in document["causes"]) == sorted(names)
    assert capsys.readouterr().out.startswith(verdict)
    assert len(document["margins"]) >= 3
    for cause in document["causes"]:
        assert cause["parameters"]["size"]["value"] == pytest.approx(3.0, abs=0.05)
        # The fan stirs the air as the wind does; the wind is no part of what is judged, so it goes first.
        tied = (
            [{"cause": "fan", "where": "room", "score_difference": 0.0}] if cause["cause"] == "wind" else None
        )
        assert cause.get("tied_with") == tied


def test_the_core_knows_no_kind():
    """What is common to all kinds imports none of them, nor what only one of them measures."""
    core = Path(kinds.__file__).parent / "core"
    sources = {path.name: path.read_text(encoding="utf-8") for path in core.glob("*.py")}
    assert len(sources) > 10
    for name, text in sources.items():
        for other in ("loading", "pose", "camera", "parts", "kinds", "wording"):
            assert f"doormill_ros.diagnosis.{other}" not in text, name
        assert "doormill_ros.measurements" not in text, name
        assert "doormill_ros.robot_model.elastic" not in text, name
