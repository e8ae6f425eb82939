"""What changed in series of runs that nobody gauged: drawn worlds with hidden changes, and quiet ones."""

import json
import shutil
from typing import Any

import pytest

from doormill_ros.tools.diagnose import main
from support.run_answers import RunAnswer, answer_of, drawn_answer, drawn_series
from support.run_series import DRAWN as DRAWN_KINDS
from support.run_series import DRIFTING, PLACES, draw_series
from support.run_series_bags import write_series

DRAWN = 24
SHARE = 0.9  # of the hidden changes that must be found


@pytest.fixture(scope="module")
def answers(tmp_path_factory) -> list[RunAnswer]:
    return [drawn_answer(seed, tmp_path_factory.mktemp("series")) for seed in range(DRAWN)]


class TestScore:
    """Drawn series."""

    def test_hidden_changes_are_named_with_their_place(self, answers):
        hidden = sum(len(answer.series.changes) for answer in answers)
        missed = [f"seed {answer.seed}: {change}" for answer in answers for change in answer.missed]
        assert len(missed) <= (1.0 - SHARE) * hidden, "\n".join(missed)

    def test_no_series_names_a_wrong_cause(self, answers):
        wrong = [line for answer in answers for line in answer.wrong]
        assert not wrong, "\n".join(wrong)

    def test_quiet_series_have_no_change(self, answers):
        loud = [
            f"seed {answer.seed}: {answer.document['verdict']}, {answer.document['changes']}"
            for answer in answers
            if not answer.series.changes and not answer.is_quiet
        ]
        assert not loud, "\n".join(loud)

    def test_steps_begin_at_their_run(self, answers):
        steps = [
            (answer, change)
            for answer in answers
            for change in answer.series.changes
            if not change.drift and change not in answer.missed
        ]
        off = [
            f"seed {answer.seed}: {change}, found {[entry['from_run'] for entry in answer.steps()]}"
            for answer, change in steps
            if not any(answer.begins(entry, change) for entry in answer.steps())
        ]
        assert steps
        assert len(off) <= (1.0 - SHARE) * len(steps), "\n".join(off)

    def test_no_step_is_found_where_none_is(self, answers):
        found = [(answer, entry) for answer in answers for entry in answer.steps()]
        stray = [
            f"seed {answer.seed}: {entry['what']} at {entry['where']} from {entry['from_run']}"
            for answer, entry in found
            if not any(change.drift or answer.begins(entry, change) for change in answer.series.changes)
        ]
        assert len(stray) <= (1.0 - SHARE) * len(found), "\n".join(stray)


def one(kind: str, tmp_path, **drawn: Any) -> RunAnswer:
    """The answer to a clear series of 24 runs of one recipe in which one thing changed."""
    fixed = {
        "count": 24,
        "probe": True,
        "marks": True,
        "repeats": 3,
        "drift": False,
        "order": "one",
        "calm": True,
    }
    return answer_of(draw_series(11, (kind,), **{**fixed, **drawn}), tmp_path)


def test_the_drawn_series_hold_every_kind():
    drawn = [drawn_series(seed) for seed in range(DRAWN)]
    assert {change.kind for series in drawn for change in series.changes} == set(DRAWN_KINDS)
    assert sum(not series.changes for series in drawn) >= 5


@pytest.mark.parametrize("kind", PLACES)
def test_one_clear_step(kind, tmp_path):
    answer = one(kind, tmp_path)
    (change,) = answer.series.changes
    assert [(cause["cause"], cause["where"]) for cause in answer.causes] == [(kind, PLACES[kind])]
    assert answer.document["verdict"] == "explained"
    assert any(answer.begins(entry, change) for entry in answer.steps())


@pytest.mark.parametrize("kind", DRIFTING)
def test_one_clear_drift(kind, tmp_path):
    answer = one(kind, tmp_path, drift=True, count=40)
    assert [(cause["cause"], cause["where"]) for cause in answer.causes] == [(kind, PLACES[kind])]
    assert "drift" in [entry["kind"] for entry in answer.document["changes"]]


@pytest.fixture(scope="module")
def with_loads(tmp_path_factory) -> list[RunAnswer]:
    return [drawn_answer(seed, tmp_path_factory.mktemp("spindle"), spindle=True) for seed in range(100, 112)]


class TestSpindle:
    """Drawn series with the load of the spindle, half of them with another work of the cut beside what else changed."""

    def test_another_work_of_the_cut_is_named(self, with_loads):
        hidden = [
            (answer, change)
            for answer in with_loads
            for change in answer.series.changes
            if change.kind == "cutting_power"
        ]
        assert len(hidden) >= 4
        assert [f"seed {a.seed}: {c}" for a, c in hidden if c in a.missed] == []

    def test_nothing_else_is_called_so(self, with_loads):
        assert [line for answer in with_loads for line in answer.wrong] == []

    def test_quiet_series_have_no_change(self, with_loads):
        quiet = [answer for answer in with_loads if not answer.series.changes]
        assert quiet
        assert [answer.seed for answer in quiet if not answer.is_quiet] == []


def test_doors_that_turn_while_the_marks_stand_are_no_camera_that_turned(tmp_path):
    """The marks of this series move by chance, a fiftieth as far as the doors turn."""
    answer = drawn_answer(5109, tmp_path, spindle=True)
    assert "clamp_shift" in [change.kind for change in answer.series.changes]
    assert answer.series.way is not None
    assert answer.wrong == []
    assert answer.missed == []


@pytest.mark.parametrize("order", ["random", "split"])
def test_another_recipe_takes_another_work_and_is_no_change(order, tmp_path):
    series = draw_series(2, (), 20, order=order, calm=True, spindle=True)
    assert len(set(series.recipes)) > 1
    assert answer_of(series, tmp_path).is_quiet


def test_a_slower_robot_takes_the_same_work(tmp_path):
    answer = one("controller_speed", tmp_path, spindle=True)
    assert [cause["cause"] for cause in answer.causes] == ["controller_speed"]


@pytest.mark.parametrize("kind", ["camera_shift", "clamp_shift"])
def test_camera_and_clamp_are_named_beside_each_other_where_nothing_tells_them_apart(kind, tmp_path):
    answer = one(kind, tmp_path, probe=False, marks=False, count=40)
    assert not answer.missed
    assert not answer.wrong


def test_marks_alone_tell_the_camera_from_the_clamp(tmp_path):
    answer = one("camera_shift", tmp_path, probe=False)
    assert [cause["cause"] for cause in answer.causes] == ["camera_shift"]


def test_a_probe_alone_tells_the_clamp_from_the_camera(tmp_path):
    answer = one("clamp_shift", tmp_path, marks=False)
    assert [cause["cause"] for cause in answer.causes] == ["clamp_shift"]


@pytest.mark.parametrize("kind", ["camera_lens", "controller_speed", "cutting_power"])
def test_a_change_is_found_whatever_order_the_recipes_come_in(kind, tmp_path):
    answer = one(kind, tmp_path, order="random", count=40)
    assert [cause["cause"] for cause in answer.causes] == [kind]


@pytest.mark.parametrize("seed", range(3))
def test_another_recipe_is_no_change(seed, tmp_path):
    assert answer_of(draw_series(seed, (), 20, order="split"), tmp_path).is_quiet


def test_one_odd_run_is_no_change(tmp_path):
    series = next(
        s for s in (draw_series(seed, (), 16) for seed in range(100)) if min(s.refused, s.upset) >= 0
    )
    assert answer_of(series, tmp_path).is_quiet


def test_one_run_alone_is_refused(tmp_path, capsys):
    write_series(draw_series(4, (), 1, order="cycle", calm=True), tmp_path / "runs")
    assert main(["--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    assert "hold 1 runs, allowed are 2 or more" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_first_run_that_leaves_none_is_named(tmp_path, capsys):
    write_series(draw_series(4, (), 3, order="cycle", calm=True), tmp_path / "runs")
    asked = ["--runs", str(tmp_path / "runs"), "--since", "zzz", "--out", str(tmp_path / "out"), "--quiet"]
    assert main(asked) == 2
    assert "hold 0 runs from 'zzz' on, allowed are 2 or more" in capsys.readouterr().err


@pytest.mark.parametrize("count", [2, 3])
def test_few_runs_tell_of_no_change(count, tmp_path):
    answer = answer_of(draw_series(4, (), count, order="cycle", calm=True), tmp_path)
    assert not answer.causes
    assert not answer.document["changes"]


def test_runs_are_ordered_by_their_time_not_by_their_folders(tmp_path):
    series = draw_series(12, ("controller_speed",), 16, True, True, 1, False, "one", calm=True)
    bags = write_series(series, tmp_path / "written")
    for number, bag in enumerate(reversed(bags)):
        (tmp_path / "runs" / f"door_{number:03d}").mkdir(parents=True)
        shutil.move(bag, tmp_path / "runs" / f"door_{number:03d}" / "bag")
    assert main(["--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    answer = RunAnswer(12, series, document)
    assert not answer.missed
    assert any(answer.begins(entry, series.changes[0]) for entry in answer.steps())


@pytest.mark.parametrize("kept", [0.0, 0.1, 0.5, 0.97])
def test_a_bag_that_was_cut_off_is_read_or_named(kept, tmp_path, capsys):
    bags = write_series(draw_series(13, (), 10, order="one", calm=True), tmp_path / "runs")
    (file,) = bags[5].glob("*.mcap")
    with file.open("r+b") as stream:
        stream.truncate(int(kept * file.stat().st_size))
    code = main(["--runs", str(tmp_path / "runs"), "--out", str(tmp_path / "out"), "--quiet"])
    said = capsys.readouterr().err
    if code == 0:
        document = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
        assert not document["causes"]
        assert not document["changes"]
    else:
        assert code == 2
        assert "door_005" in said
        assert "Traceback" not in said


@pytest.mark.parametrize("made", [True, False])
def test_a_folder_without_runs_is_told_in_one_line(made, tmp_path, capsys):
    folder = tmp_path / "runs"
    if made:
        folder.mkdir()
    assert main(["--runs", str(folder), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert str(folder) in said


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--last", "1"], "--last is 1, allowed are 2 to 200"),
        (["--last", "201"], "--last is 201, allowed are 2 to 200"),
    ],
)
def test_a_number_of_runs_of_no_use_is_refused(options, said, tmp_path, capsys):
    with pytest.raises(SystemExit) as refused:
        main(["--runs", str(tmp_path), "--out", str(tmp_path / "out"), *options])
    assert refused.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--last", "6"], ["--since", "r1"]])
def test_what_is_asked_of_runs_alone_is_refused_with_other_data(options, tmp_path, capsys):
    with pytest.raises(SystemExit) as refused:
        main(["--data", str(tmp_path), "--out", str(tmp_path / "out"), *options])
    assert refused.value.code == 2
    assert "given without --runs" in capsys.readouterr().err


def test_the_last_runs_and_those_from_one_on_can_be_asked(tmp_path):
    series = draw_series(13, (), 12, order="one", calm=True)
    write_series(series, tmp_path / "runs")
    asked = {}
    for name, options in (("last", ["--last", "8"]), ("since", ["--since", series.run_id(3)])):
        out = tmp_path / name
        assert main(["--runs", str(tmp_path / "runs"), "--out", str(out), "--quiet", *options]) == 0
        document = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
        asked[name] = [run["run_id"] for run in document["runs"]]
    assert asked["last"] == [series.run_id(run) for run in range(4, 12)]
    assert asked["since"] == [series.run_id(run) for run in range(3, 12)]
