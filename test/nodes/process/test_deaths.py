"""A few strikes of the campaign `bench/deaths.py`, and that its oracle sees what it is there for."""

from __future__ import annotations

import os
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.abb.errors import TargetFileWriteError
from doormill_ros.abb.target_file.target_file import write_target_file
from doormill_ros.cell.errors import RunNoteError
from doormill_ros.cell.run.run_in_hand import NOTE, RunNote
from support.deaths.campaign import play
from support.deaths.leftovers import Leftovers
from support.deaths.naming import Lives, named_after
from support.deaths.oracle import Oracle, Place, Placed
from support.deaths.strikes import NODES, PAIRS, STAGES, Strike, deal
from support.waiting import LIMIT

FILE = b"1000;2000;3000;1;\n#door oak\n#run r1\n#sum [1,2]\n"
#: A quarter turn about x, origin at y = 1 m: the file's target lies at (1, 3, -1) from the door.
TURNED = Place((0.0, 1.0, 0.0), (0.5**0.5, 0.0, 0.0, 0.5**0.5))
SEEN = {"oak": np.array([[1.0, 3.0, -1.0]]), "birch": np.array([[1.0, 3.0, -1.0]])}
MOVED = replace(TURNED, origin=(0.0, 1.002, 0.0))
#: The bridge with ready high and while the robot mills, the controller with ready high, stages that stand still, two
#: strikes in one run.
ROUNDS = [
    (Strike("abb_bridge", True, "ready", 0.1, 0.0),),
    (Strike("abb_bridge", True, "milling", 0.1, 0.0),),
    (Strike("cell_simulator", True, "ready", 0.1, 0.0),),
    (
        Strike("path_generator", False, "recipe", 0.0, 0.5),
        Strike("recipe_database", False, "targets", 0.0, 3.0),
    ),
    (Strike("door_localizer", True, "recipe", 0.0, 0.0), Strike("abb_bridge", True, "milling", 0.1, 0.0)),
]
STRUCK = [strike for strikes in ROUNDS for strike in strikes]


def test_nothing_is_left_out_of_a_campaign() -> None:
    dealt = deal(3, 126)
    assert {(first.stage, second.stage) for first, second in dealt} == set(PAIRS)
    kinds = {strike.kind for strikes in dealt for strike in strikes}
    assert kinds == {(node, kill, stage) for node in NODES for kill in (True, False) for stage in STAGES}
    assert deal(3, 126) == dealt != deal(4, 126)


def test_nodes_that_die_leave_a_result_and_a_cell_that_mills_again_by_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "ros"))
    tally = play(tmp_path / "cell", ROUNDS)
    assert tally.strikes == len(STRUCK)
    assert tally.struck == {strike.kind for strike in STRUCK}
    failed = tally.wrong, tally.without_result, tally.manual, tally.died, tally.not_ended, tally.left
    assert failed == ([], [], [], [], [], [])
    # Once before the rounds and once after each.
    assert tally.milled >= len(ROUNDS) + 1
    assert tally.seen >= len(ROUNDS) + 1
    assert tally.places > 1


def test_a_node_is_named_so_long_after_the_strike_that_killed_it() -> None:
    camera, path = "door x: /camera_simulator is dead: it", "door x: /path_generator is dead: it"
    fallen = [
        (Strike("path_generator", False, "pose", 0.0, 0.8), 10.0),  # too short to be dead
        (Strike("path_generator", False, "pose", 0.0, 3.0), 11.0),
        (Strike("cell_simulator", True, "pose", 0.0, 0.0), 12.0),
    ]
    now = [0.0]
    lives = Lives(lambda: now[0])
    assert named_after(path, fallen, 12.75, lives) == [1.75]
    assert named_after(camera, fallen, 13.5, lives) == [1.5]
    assert named_after("door x: /abb_bridge is dead: it", fallen, 13.0, lives) == []
    assert named_after(path, fallen[:1], 12.0, lives) == []
    assert named_after(path, [], 12.0, lives) == []
    # A bridge that was stopped meanwhile can name it once it goes on.
    held = [*fallen, (Strike("abb_bridge", False, "pose", 0.0, 1.5), 11.5)]
    assert named_after(path, held, 13.25, lives) == [0.25]
    assert named_after(path, held, 12.75, lives) == [1.75]
    # One that was started again before it was given up was never dead; the strike after that killed it.
    twice = [(Strike("path_generator", True, "pose", 0.0, 0.0), when) for when in (20.0, 22.5)]
    assert named_after(path, twice, 24.25, lives) == [4.25]
    for now[0], alive in ((19.0, 1), (21.2, 0), (21.75, 1)):
        lives.count("path_generator", alive)
    assert named_after(path, twice, 24.25, lives) == [4.25], "too late"
    now[0] = 21.5
    lives.count("path_generator", 1)
    assert named_after(path, twice, 24.25, lives) == [1.75]
    # A predecessor that is given up only now does not bring back the one that was struck.
    again = [(Strike("path_generator", True, "pose", 0.0, 0.0), when) for when in (30.0, 31.15)]
    for now[0], alive in ((31.1, 2), (31.2, 1), (32.35, 0)):
        lives.count("path_generator", alive)
    assert named_after(path, again, 33.0, lives) == [pytest.approx(1.85)]


def test_a_file_that_outlives_its_run_is_seen_when_the_next_result_comes(tmp_path: Path) -> None:
    leftovers, file = Leftovers(tmp_path, patience=0.0), tmp_path / "Hei2.txt"

    def goal(run: str, stands: bytes | None) -> list[str]:
        leftovers.sent()
        file.unlink(missing_ok=True)
        if stands is not None:
            file.write_bytes(stands)
        leftovers.told(run)
        return leftovers.found

    assert goal("r1", FILE) == []  # cleared a moment after its result is soon enough
    assert goal("r2", None) == []
    assert goal("", FILE.replace(b"r1", b"r3")) == []
    (left,) = goal("r3", FILE)
    assert "run r1" in left


def test_a_file_that_goes_while_nothing_else_is_asked_was_cleared_in_time(tmp_path: Path) -> None:
    """A goal that names a dead node is refused sooner than the folder is cleared."""
    leftovers, file = Leftovers(tmp_path), tmp_path / "Hei2.txt"
    file.write_bytes(FILE)
    leftovers.sent()
    leftovers.told("r1")
    leftovers.sent()
    clearing = threading.Timer(0.2, file.unlink)
    clearing.start()
    leftovers.told("")
    clearing.join()
    assert leftovers.found == []


def _mill(home: Path, oracle: Oracle, asked: float | None, number: int = 7) -> None:
    """What a robot's folder goes through when it takes a file that was requested then [s since the epoch], or never.

    A quick robot: it has begun before the PC's second signal, `doPathReady`, rises.
    """

    def write(name: str, level: str) -> None:
        (home / "io" / name).write_text(level)
        time.sleep(0.1)

    before = len(oracle.starts)
    write("doPathBusy", "0")
    if asked is not None:
        (home / "Hei2.req").write_text("7\n")
        os.utime(home / "Hei2.req", (asked, asked))
    (home / "Hei2.txt").write_bytes(FILE)
    write("goPathReady", str(number))
    write("doPathBusy", "1")
    write("doPathReady", "1")
    deadline = time.monotonic() + LIMIT
    while len(oracle.starts) == before:
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.mark.parametrize(
    ("stood", "asked", "wrong"),
    [
        ([("oak", "r1", TURNED)], 9.0, False),
        ([("birch", "r0", MOVED), ("oak", "r1", TURNED)], 9.0, False),
        ([("oak", "r1", MOVED), ("oak", "r1", TURNED)], 9.0, False),
        ([("oak", "r1", TURNED), ("oak", "r1", MOVED)], 9.0, True),
        ([("oak", "r1", replace(TURNED, turn=(0.0, 0.0, 0.0, 1.0)))], 9.0, True),
        ([("oak", "r1", TURNED), ("birch", "r2", TURNED)], 9.0, True),
        ([("oak", "r2", TURNED)], 9.0, True),
        ([], 9.0, True),
        # Told where the next door will stand, the robot takes the file that it asked for before.
        ([("oak", "r1", TURNED), ("oak", "r1", MOVED)], 0.5, False),
        ([("oak", "r1", TURNED), ("birch", "r2", TURNED)], 0.5, False),
        ([("birch", "r0", TURNED), ("oak", "r1", TURNED)], 0.5, True),
        ([("oak", "r1", TURNED)], None, True),
    ],
)
def test_the_oracle_sees_a_file_of_another_door_run_or_place(
    tmp_path: Path, stood: list[tuple[str, str, Place]], asked: float | None, wrong: bool
) -> None:
    """Doors are clamped at 0 s, 1 s and so on."""
    (tmp_path / "io").mkdir()
    with Oracle(tmp_path, SEEN) as oracle:
        for number, (door_id, run_id, place) in enumerate(stood):
            oracle.placed(Placed(float(number), door_id, run_id, place))
        _mill(tmp_path, oracle, asked)
    assert bool(oracle.faults()) is wrong


@pytest.mark.parametrize("number", [0, 6, 8])
def test_the_oracle_sees_a_file_that_answers_another_request_or_none(tmp_path: Path, number: int) -> None:
    (tmp_path / "io").mkdir()
    with Oracle(tmp_path, SEEN) as oracle:
        oracle.placed(Placed(0.0, "oak", "r1", TURNED))
        _mill(tmp_path, oracle, 9.0, number)
    assert len(oracle.faults()) == 1


def test_the_oracle_sees_that_the_file_of_an_earlier_request_is_milled(tmp_path: Path) -> None:
    (tmp_path / "io").mkdir()
    with Oracle(tmp_path, SEEN) as oracle:
        oracle.placed(Placed(0.0, "oak", "r1", TURNED))
        (tmp_path / "Hei2.req").write_text("6\n")
        (tmp_path / "Hei2.txt").write_bytes(FILE)
        (tmp_path / "io" / "doPathBusy").write_text("0")
        (tmp_path / "io" / "goPathReady").write_text("6")
        time.sleep(0.2)
        (tmp_path / "io" / "goPathReady").write_text("0")
        _mill(tmp_path, oracle, 9.0, 0)
    assert len(oracle.faults()) == 1


def test_a_run_that_was_cut_off_is_found_after_a_restart(tmp_path: Path) -> None:
    note = RunNote(tmp_path / "new")
    assert note.read() is None
    note.write("r1", "oak")
    assert RunNote(tmp_path / "new").read() == ("r1", "oak")
    note.clear()
    note.clear()
    assert note.read() is None


@pytest.mark.parametrize("content", ["", "[]", "{}", '"r1"', "\0", '{"run_id": "r1"}'])
def test_a_damaged_note_is_none(tmp_path: Path, content: str) -> None:
    (tmp_path / NOTE).write_text(content)
    assert RunNote(tmp_path).read() is None


def test_a_note_that_cannot_be_written_refuses_the_run_with_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "targets").touch()
    with pytest.raises(RunNoteError, match="so none is begun: check folder, rights and disk") as caught:
        RunNote(tmp_path / "targets").write("r1", "oak")
    assert caught.value.code == 883


def test_a_copy_that_cannot_be_filed_away_says_why(tmp_path: Path) -> None:
    (tmp_path / "targets").touch()
    with pytest.raises(TargetFileWriteError, match="could not be written"):
        write_target_file(tmp_path / "targets" / "r1.txt", FILE, make_folder=True)
    write_target_file(tmp_path / "new" / "r1.txt", FILE, make_folder=True)
    assert (tmp_path / "new" / "r1.txt").read_bytes() == FILE
