"""A small, seeded part of the fault campaign (bench/faults.py), and the judge itself."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.abb.target_file.target_file import read_target_file
from support.faults import small_disk
from support.faults.judge import Verdict, judge
from support.faults.run import campaign
from support.faults.scenario import KINDS, Scenario, draw
from support.faults.world import World, digest, make_file, positions

SEED = 2026
SAMPLE = (
    "no fault",
    "kill -9 in writing",
    "kill -9 in ready",
    "kill -9 in mid-write",
    "kill -9 of both",
    "torn write, unnoticed",
    "full disk",
    "duplicate request",
    "two files at once",
    "late file",
    "file of another door",
    "kill -9 at an operation, rws",
    "dropped connections",
    "delivery after the timeout",
    "sessions expire (401)",
    "late upload and late removal",
    "restarts of the controller",
)


def scenario_of(kind: str, **changes: object) -> Scenario:
    drawn = draw(SEED, KINDS.index(kind))
    return Scenario(**{**drawn.__dict__, **changes})


@pytest.fixture(scope="module")
def results() -> dict[str, Verdict]:
    scenarios = [scenario_of(kind) for kind in SAMPLE]
    return {scenario.kind: verdict for scenario, verdict in campaign(scenarios, workers=4)}


@pytest.mark.parametrize("kind", SAMPLE)
def test_no_wrong_file_is_milled_and_the_cell_recovers(results: dict[str, Verdict], kind: str) -> None:
    verdict = results[kind]
    assert not verdict.wrong
    assert not verdict.failed
    assert verdict.recovered
    assert verdict.milled >= 2
    assert verdict.requests >= verdict.milled


@pytest.mark.parametrize("kind", SAMPLE)
def test_the_fault_struck(results: dict[str, Verdict], kind: str) -> None:
    assert (results[kind].faults > 0) is (kind != "no fault")


def test_a_disk_is_full_for_a_user_who_may_not_mount(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(small_disk, "mounted", lambda _home: nullcontext(False))
    ((_, verdict),) = campaign([scenario_of("full disk")], workers=1)
    assert verdict.faults
    assert verdict.recovered
    assert not verdict.wrong


def test_even_a_robot_that_checks_nothing_mills_the_right_file() -> None:
    """The PC's part alone: the robot mills whatever lies there when ready is high."""
    kinds = ("kill -9 in ready", "torn write, unnoticed", "late file", "kill -9 of both")
    played = campaign([scenario_of(kind, robot="blind") for kind in kinds], workers=2)
    assert [scenario.kind for scenario, _ in played] == list(kinds)
    for scenario, verdict in played:
        assert not verdict.wrong, scenario.kind
        assert verdict.recovered, scenario.kind


@pytest.mark.parametrize(
    ("kind", "left_out", "found"),
    [
        ("torn write, unnoticed", "verify", "no complete file"),  # files are not read back
        ("no fault", "mark", "made for placement"),  # nobody asks for which request a file was made
    ],
)
def test_without_a_part_of_the_handshake_the_same_robot_mills_wrong_files(
    kind: str, left_out: str, found: str
) -> None:
    """Proof that the campaign can fail."""
    scenario = scenario_of(kind, robot="blind", sabotage=left_out)
    # What strikes when is chance; that none of so many runs goes wrong is out of the question.
    runs = (campaign([replace(scenario, seed=seed)], workers=1) for seed in range(30))
    assert any(found in text for ((_, verdict),) in runs for text in verdict.wrong)


def test_every_kind_has_its_turn_and_a_seed_gives_the_same_runs() -> None:
    drawn = [draw(1, index) for index in range(len(KINDS))]
    assert {scenario.kind for scenario in drawn} == set(KINDS)
    assert drawn == [draw(1, index) for index in range(len(KINDS))]
    assert [s.seed for s in drawn] != [draw(2, index).seed for index in range(len(KINDS))]


def test_target_files_of_the_campaign_are_real_ones() -> None:
    found = read_target_file(make_file(7, "door_a", "run-1"))
    assert (found.door_id, found.run_id, found.recipe_version, len(found.targets)) == (
        "door_a",
        "run-1",
        7,
        14,
    )


class TestJudge:
    """Synthetic logs."""

    @pytest.fixture
    def world(self, tmp_path: Path) -> World:
        world = World.create(tmp_path / "run")
        self.sha = digest(make_file(3, "door_a", "r"))
        world.log("planned", run="r", placement=3, door="door_a", sha=self.sha)
        return world

    def mill(self, world: World, **changes: object) -> list[str]:
        """A blind robot's log."""
        entry = {"placement": 3, "door": "door_a", "sha": self.sha, "run": "r", **changes}
        world.log("robot", event="milled", **entry)
        return judge(world).wrong

    def move(
        self, world: World, path: list[tuple[float, float]], door: str = "door_a", done: bool = True
    ) -> list[str]:
        """Motions of the RAPID modules towards the door in the clamp."""
        for y, z in path:
            world.log("robot", event="moved", placement=3, door=door, y=y, z=z)
        if done:
            world.log("robot", event="milled", placement=3, door=door)
        return judge(world).wrong

    def test_right(self, world: World) -> None:
        assert not self.mill(world)
        assert not self.move(world, positions(3, "door_a"))

    @pytest.mark.parametrize(
        ("changes", "found"),
        [
            ({"sha": digest(make_file(3, "door_a", "r")[:-1])}, "no complete file"),
            ({"placement": 4}, "placement 3"),
            ({"door": "door_b"}, "door door_a"),
        ],
    )
    def test_a_blind_robot_wrong(self, world: World, changes: dict[str, object], found: str) -> None:
        assert [text for text in self.mill(world, **changes) if found in text]

    def test_a_blind_robot_twice(self, world: World) -> None:
        self.mill(world)
        assert "milled twice" in self.mill(world)[0]

    @pytest.mark.parametrize(
        ("path", "door", "found"),
        [
            (positions(4, "door_a"), "door_a", "not the path of door_a"),
            (positions(3, "door_a"), "door_b", "not the path of door_b"),
            (positions(3, "door_a") * 2, "door_a", "milled twice"),
            (positions(3, "door_a")[:5] + positions(3, "door_a")[6:], "door_a", "1 targets left out"),
            (positions(3, "door_a")[:9], "door_a", "called done after 9 targets"),
        ],
    )
    def test_motions_wrong(
        self, world: World, path: list[tuple[float, float]], door: str, found: str
    ) -> None:
        assert [text for text in self.move(world, path, door) if found in text]

    def test_a_door_that_was_begun_and_given_up_is_not_wrong(self, world: World) -> None:
        assert not self.move(world, positions(3, "door_a")[:9], done=False)

    def test_without_a_door(self, world: World) -> None:
        world.log("robot", event="moved", placement=0, door="none", y=1.0, z=2.0)
        assert judge(world).wrong == ["milled without a door in the clamp"]

    @pytest.mark.parametrize(
        ("states", "count"),
        [
            (["failed"], 1),
            (["requested"], 1),
            (["done"], 0),
            (["clearing", "milling", "done"], 0),
            (["done", "requested", "failed"], 0),
            (["killed", "idle", "requested", "failed"], 0),
        ],
    )
    def test_a_good_door_called_failed(self, world: World, states: list[str], count: int) -> None:
        self.move(world, positions(3, "door_a"))
        life = 0
        for reached in ("ready", "milling", *states):
            life += reached == "killed"
            world.log("bridge", life=life, state=reached, reason="why", run="r")
        assert len(judge(world).failed) == count
