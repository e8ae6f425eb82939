"""Whether a cell is ready, from what was heard of its nodes."""

from __future__ import annotations

import pytest

from doormill_ros.cell.graph.readiness import NEEDED, SILENCE, Readiness


class Cell:
    """Every node was heard of, well and just now, unless told otherwise."""

    def __init__(self) -> None:
        self.now = 100.0
        self.readiness = Readiness(clock=lambda: self.now)
        for name in NEEDED:
            self.readiness.hear(name, 0, "active")

    def hindrances(self) -> list[str]:
        return self.readiness.hindrances(camera=True)


def test_a_cell_whose_nodes_are_well_is_ready() -> None:
    assert Cell().hindrances() == []


def test_nobody_was_heard_of() -> None:
    found = Readiness(clock=lambda: 0.0).hindrances(camera=False)
    assert [line.split(":")[0] for line in found] == [*NEEDED, "camera"]


def test_who_listened_too_shortly_says_so() -> None:
    now = [0.0]
    readiness = Readiness(clock=lambda: now[0])
    now[0] = 1.0
    (first, *_) = readiness.hindrances(camera=True)
    assert first == f"{NEEDED[0]}: not heard of in 1.0 s of listening; wait longer, or start it"


@pytest.mark.parametrize("name", NEEDED)
def test_a_node_that_fell_silent_is_named(name: str) -> None:
    cell = Cell()
    cell.now += SILENCE + 0.1
    for other in set(NEEDED) - {name}:
        cell.readiness.hear(other, 0, "active")
    (line,) = cell.hindrances()
    assert line.startswith(f"{name}: not heard of for 3 s")


@pytest.mark.parametrize(
    ("name", "level", "message", "said"),
    [
        ("door_localizer", 1, "inactive", "door_localizer: inactive; activate it"),
        ("path_generator", 1, "unconfigured", "path_generator: unconfigured"),
        (
            "recipe_database",
            2,
            "could not configure: no disk",
            "recipe_database: could not configure: no disk",
        ),
        ("abb_bridge/controller", 1, "it is in manual mode", "controller: it is in manual mode"),
        ("abb_bridge/controller", 2, "emergency stop", "controller: emergency stop"),
        ("robot2/abb_bridge/controller", 1, "it is in manual mode", "controller of robot2: it is in manual"),
        ("robot2/abb_bridge", 2, "no folder", "robot2/abb_bridge: no folder"),
        ("camera_driver", 2, "no link", "camera_driver: no link"),
        ("bag_recorder", 3, "stale", "bag_recorder: stale"),
    ],
)
def test_what_hinders_is_told(name: str, level: int, message: str, said: str) -> None:
    cell = Cell()
    cell.readiness.hear(name, level, message)
    (line,) = cell.hindrances()
    assert line.startswith(said)


@pytest.mark.parametrize(
    ("name", "message"), [("door_localizer", "door oak: nothing straight"), ("abb_bridge/controller", "")]
)
def test_a_refused_door_or_a_fit_controller_hinders_nothing(name: str, message: str) -> None:
    cell = Cell()
    cell.readiness.hear(name, 1 if message else 0, message or "takes files")
    assert cell.hindrances() == []


def test_pictures_are_needed() -> None:
    (line,) = Cell().readiness.hindrances(camera=False)
    assert line == "camera: nobody offers pictures; start its driver"
