"""A kind of data that nobody thought of: a problem, its causes and one line make it a diagnosis like the others."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.core.fitting.problem import Examined, Prediction, make_folds
from doormill_ros.diagnosis.core.kind import SearchedKind
from doormill_ros.diagnosis.core.words.wording import Unit, Words
from doormill_ros.diagnosis.listed_kind import FurtherOption, ListedKind
from doormill_ros.pages.page import PageSection, Paragraphs
from doormill_ros.robot_model.candidate import Candidate, CauseParameter
from doormill_ros.tools.diagnose import main

SCHEMA = "invented/room-set/1"


class Draught(Candidate):
    """The thermometers of a room read too much, in proportion to a column of numbers."""

    def __init__(self, name, column, named=True, of_robot=True):
        super().__init__("room")
        self.name, self.column, self.named, self.of_robot = name, column, named, of_robot
        self.parameters = (CauseParameter("size", "K", -10.0, 10.0),)
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
    unit = Unit("K", "K", 2, 1.0)

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


class Rooms(SearchedKind[Room, Room, Draught]):
    """Rooms by what is hidden in them; told in kelvin, with a model and a page of their own."""

    words = Words("thermometer", "readings", "reading", "reading", "rooms", "By opening windows.")
    next_measurement = "open a window"

    def read(self, folder, progress):
        progress("reading the thermometers")
        document = yaml.safe_load((folder / "set.yaml").read_text())
        return [a_room(document["hidden"], document.get("seed", 0))]

    def problem(self, sets):
        (room,) = sets
        return room

    def name(self, one):
        return "the room"

    def account(self, diagnosis, sets, checks, progress):
        account = super().account(diagnosis, sets, checks, progress)
        by_door = {f"thermometer {k + 1}": float(np.std(sets[0].readings[:, k])) for k in range(3)}
        return replace(
            account,
            sections={"by_thermometer": by_door},
            model={"schema": "invented/model/1", "causes": [cause.cause for cause in account.causes]},
            evidence=[PageSection("What the windows show", [Paragraphs(["They are shut."])])],
        )


def diagnose(folder, hidden, *more, check=None):
    """Exit status, and the folder of what was written."""
    data = {"data": hidden} | ({} if check is None else {"check": check})
    arguments = []
    for name, effects in data.items():
        (folder / name).mkdir()
        text = yaml.safe_dump({"schema": SCHEMA, "hidden": effects, "seed": len(arguments)})
        (folder / name / "set.yaml").write_text(text)
        arguments += [f"--{name}", str(folder / name)]
    return main([*arguments, "--out", str(folder / "out"), *more]), folder / "out"


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setattr(kinds, "KINDS", (*kinds.KINDS, ListedKind(SCHEMA, Rooms)))


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
def test_one_line_makes_a_kind(registered, tmp_path, capsys, hidden, verdict, names):
    code, out = diagnose(tmp_path, hidden, "--quiet")
    assert code == 0
    document = json.loads((out / "diagnosis.json").read_text())
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


def test_a_kind_of_its_own_goes_through_document_model_and_page(registered, tmp_path, capsys):
    code, out = diagnose(tmp_path, ["sun"], check=["sun"])
    assert code == 0
    line, err = capsys.readouterr()
    assert "reading the thermometers" in err
    assert "60 trials in 12 configurations, noise floor 0.10 K" in err
    document = json.loads((out / "diagnosis.json").read_text())
    assert (document["schema"], document["unit"]) == ("doormill/diagnosis/1", "K")
    before, after = (document[model]["holdout_rmse"] for model in ("baseline", "extended"))
    assert line == f"explained: sun at room; held-out reading {before:.2f} -> {after:.2f} K, noise 0.10 K\n"
    assert after < 0.12 < 2.0 < before
    assert set(document["by_thermometer"]) == {f"thermometer {k}" for k in (1, 2, 3)}
    [check] = document["checks"]
    assert (check["set"], check["rows"]) == ("the room", 60)
    # Another day has another sun: what was learnt of this one does not help there.
    assert check["extended"]["rmse"] > check["baseline"]["rmse"] > 2.0
    model = yaml.safe_load((out / document["extended_model"]).read_text())
    assert model == {"schema": "invented/model/1", "causes": ["sun"]}
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.count("<h1>Explained: sun (") == 1
    titles = re.findall("<h2>(.*?)</h2>", page)
    common = ["Causes", "Candidates", "What cannot be told apart", "What to measure next"]
    assert titles.index("Causes") < titles.index("What the windows show") < titles.index("Candidates")
    assert [title for title in titles if title in common] == common
    assert {"How close the decisions were", "Sets that were only predicted"} < set(titles)
    assert "By opening windows." in page
    assert f"{before:.2f} K" in page


def test_a_kind_may_have_an_option_of_its_own(monkeypatch, tmp_path, capsys):
    chambers = ListedKind(SCHEMA, Rooms, "chambers", "rooms that are heard about")
    monkeypatch.setattr(kinds, "KINDS", (*kinds.KINDS, chambers))
    with pytest.raises(SystemExit):
        main(["--help"])
    options = capsys.readouterr().out
    assert {"--chambers", "--pictures", "--inspections"} <= set(options.replace("]", " ").split())
    (tmp_path / "set.yaml").write_text(yaml.safe_dump({"schema": SCHEMA, "hidden": []}))
    assert main(["--chambers", str(tmp_path), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert capsys.readouterr().out.startswith("consistent: the reading of ")


def test_what_goes_with_that_option_is_told_the_kind(monkeypatch, tmp_path, capsys):
    told = []
    further = (
        FurtherOption("first_room", "N", "the first room that counts", int, range(3)),
        FurtherOption("tone", "T", "what they are asked with"),
    )

    def make(**given):
        told.append(given)
        return Rooms()

    chambers = ListedKind(SCHEMA, make, "chambers", "rooms that are heard about", further)
    monkeypatch.setattr(kinds, "KINDS", (*kinds.KINDS, chambers))
    (tmp_path / "set.yaml").write_text(yaml.safe_dump({"schema": SCHEMA, "hidden": []}))
    asked = ["--chambers", str(tmp_path), "--out", str(tmp_path / "out"), "--quiet"]
    assert main([*asked, "--first-room", "2"]) == 0
    assert told == [{"first_room": 2}]
    for wrong, sentence in (
        ([*asked, "--first-room", "3"], "--first-room is 3, allowed are 0 to 2"),
        (["--thesis", "--tone", "low", "--out", "x"], "--first-room or --tone was given without --chambers"),
    ):
        with pytest.raises(SystemExit):
            main(wrong)
        assert sentence in capsys.readouterr().err


def test_the_core_knows_no_kind():
    """What is common to all kinds imports none of them, nor what only one of them measures."""
    core = Path(kinds.__file__).parent / "core"
    sources = {str(path.relative_to(core)): path.read_text(encoding="utf-8") for path in core.rglob("*.py")}
    assert len(sources) > 30
    for name, text in sources.items():
        for other in ("loading", "pose", "camera", "parts", "motion", "kinds"):
            assert f"doormill_ros.diagnosis.{other}" not in text, name
        assert "doormill_ros.measurements" not in text, name
        assert "doormill_ros.robot_model.elastic" not in text, name
