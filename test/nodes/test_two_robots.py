"""One goal for one door, milled by two robots: two path generators, bridges and controllers in namespaces."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import httpx

from doormill_ros.abb.target_file.target_file import read_target_file
from doormill_ros.cell.errors import NodeInactiveError
from doormill_ros.cell.run_folder import RunFolder
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.nodes.cell import Cell, CellOptions, run_once
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.report.run_report import write_report
from support.cell_processes import free_port

DOOR = "standard_door"


def heard(folder: Path) -> dict[str, list[Any]]:
    """Messages by topic, as the recorder heard them."""
    found: dict[str, list[Any]] = {}
    for item in read_bag(folder / "bag"):
        found.setdefault(item.topic, []).append(item.message)
    return found


def states(found: dict[str, list[Any]], robot: str) -> list[str]:
    """What the handshake of a robot went through."""
    return [message.state for message in found[f"/{robot}/abb/status"]]


def test_two_robots_mill_a_door_and_the_second_begins_when_the_first_is_home(tmp_path: Path) -> None:
    summary = run_once(DOOR, tmp_path, CellOptions(robots=2))
    assert summary.success, summary.message
    assert summary.measured
    assert summary.feature_error.corrected_max < summary.feature_error.tolerance
    # The judge saw what both did, and neither touched the other or anything else.
    assert summary.touched.samples == 0
    files = [tmp_path / "targets" / f"robot{number}" / f"{summary.run_id}.txt" for number in (1, 2)]
    shares = [read_target_file(file.read_bytes()) for file in files]
    assert [share.run_id for share in shares] == [summary.run_id] * 2
    milled = [
        {line.split()[1] for line in f.read_text().splitlines() if line.startswith("#feature")} for f in files
    ]
    assert all(milled)
    assert {"hinge_1", "hinge_2", "hinge_3"} <= milled[0]
    assert "lock_case" in milled[1] - milled[0]
    found = heard(tmp_path)
    executed = [found[f"/robot{number}/simulation/executed_path"][-1] for number in (1, 2)]
    assert summary.touched.judged == sum(len(path.time) for path in executed)
    # By the bridges' own stamps, one clock for both, the second took up its file after the first had told of its end.
    (first,) = [m for m in found["/robot1/share/result"] if m.run_id == summary.run_id]
    writing = [m for m in found["/robot2/abb/status"] if m.state == "writing" and m.run_id == summary.run_id]
    assert first.success
    assert all(seconds_of(first.header.stamp) < seconds_of(m.header.stamp) for m in writing)
    assert writing
    (result,) = found["/run/result"]
    assert (result.run_id, result.success) == (summary.run_id, True)
    assert json.loads((tmp_path / "summary.json").read_text())["success"]
    replayed = replay_bag(tmp_path / "bag")
    assert replayed.found == []
    for number in (1, 2):
        targets = f"/robot{number}/path/targets"
        assert replayed.counts[targets] == len(found[targets])
        assert replayed.counts[f"/robot{number}/abb/target_file"] == 1


def test_the_summary_of_one_robot_tells_what_two_would_need(tmp_path: Path) -> None:
    summary = run_once(DOOR, tmp_path, CellOptions())
    assert summary.success, summary.message
    told = json.loads((tmp_path / "summary.json").read_text())["cycle"]
    assert told["two"] < told["allowed"] < told["one"]
    write_report(tmp_path / "bag", tmp_path / "report.html")
    assert summary.cycle.sentence in (tmp_path / "report.html").read_text()


def test_without_the_bridge_of_one_robot_nothing_is_milled(tmp_path: Path) -> None:
    missing = {"robot2/abb_bridge": {"autostart": False}}
    summary = run_once(DOOR, tmp_path, CellOptions(missing, robots=2))
    assert (summary.success, summary.error_code) == (False, NodeInactiveError.code)
    assert "second robot" in summary.message
    # Neither a copy nor what a controller reads.
    assert not list(tmp_path.rglob("*.txt"))


def test_a_first_robot_that_stops_with_a_fault_keeps_the_second_one_still(tmp_path: Path) -> None:
    faulty = {"robot1/controller_simulator": {"spindle_works": False}}
    summary = run_once(DOOR, tmp_path, CellOptions(faulty, robots=2))
    assert (summary.success, summary.error_code) == (False, 491)
    assert "first robot" in summary.message
    found = heard(tmp_path)
    assert "milling" in states(found, "robot1")
    assert "milling" not in states(found, "robot2")
    assert not any(message.data for message in found["/robot2/abb/ready"])


def test_the_page_tells_of_both_robots_and_of_the_door_they_milled(tmp_path: Path) -> None:
    port = free_port()
    chosen = CellOptions({"operator_page": {"port": port}}, page=True, robots=2)
    folder = RunFolder(tmp_path)
    folder.prepare()
    with (
        Cell(folder, chosen) as cell,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60.0) as page,
    ):
        summary = cell.mill(DOOR)
        assert summary.success, summary.message

        def whole(told: dict[str, Any]) -> bool:
            """The last messages have come."""
            measured = told["drawing"] and all(one["deviation"] >= 0.0 for one in told["drawing"]["features"])
            both = all(robot["does"] == "share" for robot in told["robots"])
            return bool(measured and both and told["history"])

        deadline = time.monotonic() + 60.0
        while not whole(told := page.get("/state").json()):
            assert time.monotonic() < deadline, told
            time.sleep(0.05)
    assert told["step"]["key"] == "done_both"
    assert told["history"][0]["run_id"] == summary.run_id
    for feature in told["drawing"]["features"]:
        assert feature["came_to"] == "within"
        # Of each robot's own program; a half of a through hole is in both.
        assert all(0.0 <= share["begin"] < share["end"] for share in feature["shares"])
    assert {share["robot"] for one in told["drawing"]["features"] for share in one["shares"]} == {1, 2}
    assert told["faults"] == []
