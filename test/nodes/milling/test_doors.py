"""The nodes as separate processes mill every shipped door; what lands on disk is checked from outside."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from doormill_ros.abb.target_file.target_file import read_target_file
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.nodes.base import topics
from doormill_ros.recipes.documents import shipped_recipes
from support.cell_processes import CellProcesses

DOORS = sorted(shipped_recipes())
THESIS_TARGETS = 14  # figure 3.40
#: Accuracy that the thesis reports for its vision system [m] (table 4.7).
THESIS_ACCURACY = 0.2e-3
STAGES = ["recipe", "picture", "pose", "targets", "ready", "milling"]


@pytest.fixture(scope="module")
def milled(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """All doors one after the other in one running cell."""
    folder = tmp_path_factory.mktemp("cell")
    runs: dict[str, Any] = {"folder": folder}
    with CellProcesses(folder) as cell:
        placements = cell.subscribe(topics.DOOR_PLACEMENT)
        localizations = cell.subscribe(topics.DOOR_LOCALIZATION)
        milled_doors = cell.subscribe(topics.MILLED_DOOR)
        runs["refused"] = 0
        heard: list[str] = []
        while not heard:  # until the bridge knows this client well enough to send it feedback
            runs["refused"] += 1
            heard = cell.mill("no_such_door")[1]
            assert runs["refused"] < 100
        for door in DOORS:
            result, stages = cell.mill(door)
            runs[door] = {"result": result, "stages": stages}
            if result.success:
                for name, messages in (
                    ("placement", placements),
                    ("localization", localizations),
                    ("milled", milled_doors),
                ):
                    runs[door][name] = cell.wait(lambda m=messages, r=result: _of(m, r.run_id))
        runs["logs"] = {name: cell.log(name) for name in cell.processes}
        runs["status"] = {name: cell.stop(name) for name in list(cell.processes)}
    return runs


def _of(messages: list[Any], run_id: str) -> Any:
    return next((m for m in messages if m.run_id == run_id), None)


def test_the_doors_are_those_of_the_thesis_and_two_more() -> None:
    assert DOORS == [
        "leaf_hinge_door",
        "nine_point_door",
        "standard_door",
        "thesis_1350_0deg",
        "thesis_1350_2deg",
        "thesis_190_0deg",
        "thesis_190_2deg",
    ]


@pytest.mark.parametrize("door", DOORS)
def test_the_action_succeeds_through_all_stages(milled: dict[str, Any], door: str) -> None:
    run = milled[door]
    assert run["result"].success, run["result"].message
    assert run["result"].error_code == 0
    assert list(dict.fromkeys(run["stages"])) == STAGES


@pytest.mark.parametrize("door", DOORS)
def test_the_target_file_is_complete_and_of_this_run(milled: dict[str, Any], door: str) -> None:
    result = milled[door]["result"]
    data = Path(result.target_file).read_bytes()
    assert hashlib.sha256(data).hexdigest() == result.sha256
    file = read_target_file(data)
    assert (file.door_id, file.run_id) == (door, result.run_id)
    assert max(len(line) for line in data.decode("ascii").splitlines()) <= 80
    if door.startswith("thesis"):
        assert len(file.targets) == THESIS_TARGETS


@pytest.mark.parametrize("door", DOORS)
def test_the_door_is_found_where_the_simulation_put_it(milled: dict[str, Any], door: str) -> None:
    found, true = milled[door]["localization"], milled[door]["placement"]
    assert abs(found.offset_y - true.offset_y) < THESIS_ACCURACY
    assert abs(found.offset_z - true.offset_z) < THESIS_ACCURACY
    limits = load_layout().limits
    assert abs(true.offset_y) <= limits.y
    assert abs(true.offset_rotation) <= limits.rotation + 1e-12


def test_the_rotated_doors_of_the_thesis_stand_rotated(milled: dict[str, Any]) -> None:
    for door in ("thesis_190_2deg", "thesis_1350_2deg"):
        assert milled[door]["placement"].offset_rotation == pytest.approx(0.0349066, abs=1e-7)


@pytest.mark.parametrize("door", DOORS)
def test_the_correction_brings_the_contour_within_tolerance(milled: dict[str, Any], door: str) -> None:
    part = milled[door]["milled"]
    assert part.corrected_max < part.tolerance
    # How much of a deflection is corrected depends on how well its force is known.
    assert part.corrected_max < part.uncorrected_max
    assert part.features
    assert all(f.corrected_max < f.uncorrected_max for f in part.features)
    assert all(len(f.arc_length) > 100 for f in part.features)


def test_the_controller_is_left_clean(milled: dict[str, Any]) -> None:
    home = milled["folder"] / "HOME"
    assert not (home / "Hei2.txt").exists()
    assert (home / "io" / "doPathReady").read_text() == "0"


def test_every_node_ends_on_interrupt(milled: dict[str, Any]) -> None:
    assert milled["status"] == dict.fromkeys(milled["status"], 0)
    assert len(milled["status"]) == 6
    assert milled["logs"].keys() == milled["status"].keys()
    for name, log in milled["logs"].items():
        assert "Traceback" not in log, f"{name}: {log}"


def _expected_counts(counts: dict[str, int], refused: int) -> None:
    n = len(DOORS)
    assert counts["/door/recipe"] == n
    # Of the goals that were refused before DDS made the recorder known it gets the latest, as every late joiner.
    assert n + 1 <= counts["/run/result"] <= n + refused
    # On a loaded machine the camera takes a second picture before the targets are ready.
    for topic in ("/door/localization", "/door/pose", "/path/targets"):
        assert counts[topic] >= n, topic
    assert counts["/simulation/milled_door"] == n
    assert counts["/simulation/executed_path"] == n
    assert counts["/camera/image_raw"] >= n
    assert counts["/diagnostics"] > 6
    # Every run raises and lowers each signal once; the first message tells the state at the start.
    assert counts["/abb/request"] >= 2 * n
    assert counts["/abb/ready"] >= 2 * n


def test_rosbags_reads_the_bag(milled: dict[str, Any]) -> None:
    with AnyReader([milled["folder"] / "bag"]) as reader:
        _expected_counts({t: info.msgcount for t, info in reader.topics.items()}, milled["refused"])
        connections = [c for c in reader.connections if c.topic == "/path/targets"]
        doors = [
            reader.deserialize(data, c.msgtype).door_id
            for c, _, data in reader.messages(connections=connections)
        ]
    assert list(dict.fromkeys(doors)) == DOORS


def test_the_mcap_library_reads_the_bag_with_the_schemas_in_it(milled: dict[str, Any]) -> None:
    (path,) = (milled["folder"] / "bag").glob("*.mcap")
    counts: dict[str, int] = {}
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            if channel.topic == "/run/result":
                assert message.success or message.door_id == "no_such_door"
    _expected_counts(counts, milled["refused"])


def test_ready_is_high_only_between_request_and_acknowledgement(milled: dict[str, Any]) -> None:
    with AnyReader([milled["folder"] / "bag"]) as reader:
        connections = [c for c in reader.connections if c.topic == "/abb/status"]
        states = [
            reader.deserialize(data, c.msgtype) for c, _, data in reader.messages(connections=connections)
        ]
    ready = [s for s in states if s.ready]
    assert len(ready) == len(DOORS)
    assert all(s.request and s.state == "ready" for s in ready)
